//! `--foxglove`: the live server among the sinks.

use std::net::SocketAddr;

use graintwin::sink::Sink;
use graintwin::view::foxglove::Server;
use graintwin::view::picture::Painter;

use super::Failure;

/// Where the server listens unless another address is given.
const DEFAULT: &str = "127.0.0.1:8765";

/// Whether and where it is asked for.
#[derive(Debug, clap::Args)]
pub(super) struct Asked {
    /// Shows everything live to Foxglove or Lichtblick, which connect to ws://ADDRESS. Nothing
    /// protects the server: an address that other machines reach shows it to whoever is there.
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = DEFAULT)]
    #[arg(value_parser = address)]
    foxglove: Option<SocketAddr>,
}

fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse().map_err(|_| format!("allowed: IP:PORT, as {DEFAULT} or [::1]:8765"))
}

impl Asked {
    /// Starts it, if it is asked for: clients can connect while the specimen is still made.
    pub(super) fn start(&self) -> Result<Option<Live>, Failure> {
        let Some(address) = self.foxglove else { return Ok(None) };
        let server = Server::start(address).map_err(Failure::input)?;
        let address = server.address();
        if !address.ip().is_loopback() {
            tracing::warn!(
                "Foxglove is served at {address} to whoever reaches it: no password, no encryption"
            );
        }
        tracing::info!("Foxglove is served at ws://{address}");
        Ok(Some(Live(server)))
    }
}

/// The server.
pub(super) struct Live(Server);

impl Live {
    /// What takes the answers.
    pub(super) fn sink(&mut self, painter: Painter) -> Result<Box<dyn Sink>, Failure> {
        Ok(Box::new(self.0.sink(painter).map_err(Failure::other)?))
    }

    /// Sends what waits and closes.
    pub(super) fn end(self) {
        let shown = self.0.stop();
        tracing::info!("the Foxglove server had {} clients", shown.clients);
        if shown.skipped > 0 {
            tracing::warn!(
                "{} increments were served faster than they could be drawn: the Foxglove server \
                 left their contact networks and pictures out",
                shown.skipped
            );
        }
    }
}
