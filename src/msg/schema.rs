//! What a message type is called, how its definition reads, and its hash.

/// A message type as ROS 2 and rosbag2 know it.
#[derive(Debug, PartialEq, Eq)]
pub struct MessageType {
    /// Package, as `graintwin_msgs`.
    pub package: &'static str,
    /// Name in the package, as `WallForces`.
    pub name: &'static str,
    /// The `.msg` text.
    pub text: &'static str,
    /// Types of its fields, each once, in alphabetical order.
    pub uses: &'static [&'static MessageType],
    /// Hash of the type description after ROS enhancement proposal 2011, `RIHS01_...`.
    pub hash: &'static str,
}

/// A struct that stands for a message type.
pub trait Described {
    /// The type.
    const TYPE: &'static MessageType;
}

impl MessageType {
    /// `package/msg/Name`.
    #[must_use]
    pub fn full_name(&self) -> String {
        format!("{}/msg/{}", self.package, self.name)
    }

    /// The schema of encoding `ros2msg`: this text, then the text of every type it is made of,
    /// depth first and each once, under a separator and the type's name as rosbag2 writes them.
    #[must_use]
    pub fn definition(&'static self) -> String {
        let mut definition = self.text.to_owned();
        let mut told = Vec::new();
        self.append_parts(&mut definition, &mut told);
        definition
    }

    fn append_parts(&self, definition: &mut String, told: &mut Vec<&'static MessageType>) {
        for &part in self.uses {
            if told.contains(&part) {
                continue;
            }
            told.push(part);
            let rule = "=".repeat(80);
            definition.push_str(&format!("\n{rule}\nMSG: {}/{}\n", part.package, part.name));
            definition.push_str(part.text);
            part.append_parts(definition, told);
        }
    }
}

/// Gives a struct its [`MessageType`] and makes it a message of the node.
macro_rules! describe {
    ($message:ident, $package:literal, $text:expr, $uses:expr, $hash:literal) => {
        impl $crate::msg::schema::Described for $message {
            const TYPE: &'static $crate::msg::schema::MessageType =
                &$crate::msg::schema::MessageType {
                    package: $package,
                    name: stringify!($message),
                    text: $text,
                    uses: $uses,
                    hash: concat!("RIHS01_", $hash),
                };
        }

        #[cfg(feature = "ros")]
        impl ros2_client::Message for $message {}
    };
}
pub(super) use describe;
