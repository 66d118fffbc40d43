//! Why nobody can look on.

use std::io;
use std::net::SocketAddr;

use ::foxglove::FoxgloveError;

/// Why there is no live server.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// Something else listens there.
    #[error("cannot serve Foxglove at {0}: the port is in use; name another IP:PORT")]
    InUse(SocketAddr),
    /// The address cannot be listened at.
    #[error("cannot serve Foxglove at {address}: {reason}; name an IP:PORT of this machine")]
    Address {
        /// The address.
        address: SocketAddr,
        /// What the system said.
        reason: String,
    },
    /// The system gives no thread.
    #[error("cannot serve Foxglove: no thread for it: {0}")]
    Thread(io::Error),
    /// A topic cannot be offered.
    #[error("cannot serve Foxglove: {0}")]
    Topic(FoxgloveError),
}

impl ServeError {
    pub(super) fn bind(address: SocketAddr, error: FoxgloveError) -> Self {
        match error {
            FoxgloveError::Bind(error) if error.kind() == io::ErrorKind::AddrInUse => {
                Self::InUse(address)
            }
            FoxgloveError::Bind(error) => Self::Address { address, reason: error.to_string() },
            error => Self::Address { address, reason: error.to_string() },
        }
    }
}
