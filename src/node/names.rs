//! What the node and its topics and services are called on the network.
//!
//! Recordings know none of this: they keep the names of [`crate::msg::topics`].

use super::args::{Remap, RemapKind};
use crate::msg::topics;

/// Longest name of a node that ROS 2 allows.
const LONGEST_NODE: usize = 255;

/// Longest namespace that ROS 2 allows.
const LONGEST_NAMESPACE: usize = 245;

/// Name and namespace of the node, and the rules for the names of its topics and services.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    name: String,
    /// `/`, or absolute without a slash at the end.
    namespace: String,
    /// From and to, as absolute names.
    rules: Vec<(String, String)>,
}

impl Default for Identity {
    fn default() -> Self {
        Self { name: topics::NODE.into(), namespace: "/".into(), rules: Vec::new() }
    }
}

impl Identity {
    /// The identity after `rules`, of which the first that fits counts: for the name of the node
    /// those for any node or for its name before, for all else those for its name after.
    #[must_use]
    pub fn new(rules: &[Remap]) -> Self {
        let mut identity = Self::default();
        let first = |node: &str, take: fn(&RemapKind) -> Option<&String>| {
            rules
                .iter()
                .filter(|rule| is_for(rule, node))
                .find_map(|rule| take(&rule.kind))
                .cloned()
        };
        let renamed = first(&identity.name, |kind| match kind {
            RemapKind::Node(name) => Some(name),
            _ => None,
        });
        identity.name = renamed.unwrap_or(identity.name);
        let moved = first(&identity.name, |kind| match kind {
            RemapKind::Namespace(namespace) => Some(namespace),
            _ => None,
        });
        identity.namespace = moved.unwrap_or(identity.namespace);
        identity.rules = rules
            .iter()
            .filter(|rule| is_for(rule, &identity.name))
            .filter_map(|rule| match &rule.kind {
                RemapKind::Name { from, to } => Some((identity.expand(from), identity.expand(to))),
                _ => None,
            })
            .collect();
        identity
    }

    /// The node's name without its namespace.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The node's namespace, `/` or `/a/b`.
    #[must_use]
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// The node's name with its namespace, `/graintwin` or `/a/b/graintwin`.
    #[must_use]
    pub fn full_name(&self) -> String {
        self.expand(&self.name)
    }

    /// The name of the node's logger, `graintwin` or `a.b.graintwin`.
    #[must_use]
    pub fn logger(&self) -> String {
        self.full_name().trim_start_matches('/').replace('/', ".")
    }

    /// The absolute name of a topic or a service that the program calls `name`: absolute (`/a`),
    /// relative to the namespace (`a`) or to the node (`~/a`).
    #[must_use]
    pub fn resolve(&self, name: &str) -> String {
        let name = self.expand(name);
        match self.rules.iter().find(|(from, _)| *from == name) {
            Some((_, to)) => to.clone(),
            None => name,
        }
    }

    fn expand(&self, name: &str) -> String {
        let within = self.namespace.trim_end_matches('/');
        match name.strip_prefix("~/") {
            Some(private) => format!("{within}/{}/{private}", self.name),
            None if name.starts_with('/') => name.into(),
            None => format!("{within}/{name}"),
        }
    }
}

fn is_for(rule: &Remap, node: &str) -> bool {
    rule.node.as_ref().is_none_or(|name| name == node)
}

/// Whether `name` can be a node's.
pub(super) fn check_node(name: &str) -> Result<(), String> {
    if !is_token(name) || name.len() > LONGEST_NODE {
        return Err(format!(
            "`{name}` is no name of a node: letters, digits and single _ are allowed, no digit in \
             front, at most {LONGEST_NODE} of them"
        ));
    }
    Ok(())
}

/// Whether `namespace` is absolute and well-formed.
pub(super) fn check_namespace(namespace: &str) -> Result<(), String> {
    let inner = namespace.strip_prefix('/');
    let fits = inner.is_some_and(|inner| inner.is_empty() || inner.split('/').all(is_token));
    if !fits || namespace.len() > LONGEST_NAMESPACE {
        return Err(format!(
            "`{namespace}` is no namespace: / or /a/b is allowed, names of letters, digits and \
             single _ without a digit in front, at most {LONGEST_NAMESPACE} characters"
        ));
    }
    Ok(())
}

/// Whether `name` can be a topic's or a service's.
pub(super) fn check_name(name: &str) -> Result<(), String> {
    if name.contains('*') {
        return Err(format!(
            "`{name}`: wildcards are not known in the names of topics and services"
        ));
    }
    let inner = name.strip_prefix("~/").or_else(|| name.strip_prefix('/')).unwrap_or(name);
    if !inner.split('/').all(is_token) {
        return Err(format!(
            "`{name}` is no name of a topic or service: /a/b, a/b and ~/a/b are allowed, of \
             letters, digits and single _ without a digit in front"
        ));
    }
    Ok(())
}

fn is_token(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && token.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !token.contains("__")
}

#[cfg(test)]
mod tests;
