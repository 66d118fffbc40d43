//! `[NODE:]FROM:=TO`.

use crate::node::names;

/// A rule that renames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remap {
    /// The node it is for; `None` for every node.
    pub node: Option<String>,
    /// What it renames.
    pub kind: RemapKind,
}

/// What a rule renames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RemapKind {
    /// The node: its new name.
    Node(String),
    /// The node's namespace: the new one, absolute.
    Namespace(String),
    /// A topic or a service. Both names are absolute (`/a`), relative to the namespace (`a`) or
    /// to the node (`~/a`).
    Name {
        /// The name in the program.
        from: String,
        /// The name to use instead.
        to: String,
    },
}

pub(super) fn parse(rule: &str) -> Result<Remap, String> {
    let (left, to) = rule.split_once(":=").ok_or("a rule reads FROM:=TO, with := between")?;
    for scheme in ["rostopic://", "rosservice://"] {
        if left.contains(scheme) {
            return Err(format!(
                "{scheme} is not known here: FROM alone renames topics and services"
            ));
        }
    }
    let (node, from) = match left.split_once(':') {
        Some((node, from)) => (Some(node), from),
        None => (None, left),
    };
    if let Some(node) = node {
        names::check_node(node)?;
    }
    let kind = match from {
        "__node" | "__name" => {
            names::check_node(to)?;
            RemapKind::Node(to.into())
        }
        "__ns" => {
            names::check_namespace(to)?;
            RemapKind::Namespace(to.into())
        }
        _ => {
            names::check_name(from)?;
            names::check_name(to)?;
            RemapKind::Name { from: from.into(), to: to.into() }
        }
    };
    Ok(Remap { node: node.map(Into::into), kind })
}
