//! What `run` does once it is known with what; `replay` does it with the recordings of others.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use indicatif::MultiProgress;

use graintwin::scene::Loaded;
use graintwin::sink::Sink;
use graintwin::twin::Twin;
use graintwin::view::picture::Painter;

use super::foxglove::Live;
use super::orders::{Broken, Feed, Orders};
use super::progress::Progress;
use super::recording::Recording;
use super::resume::Earlier;
use super::ros::{Link, Setup};
use super::specimen::{self, Specimen};
use super::summary::Summary;
use super::{Cli, Failure, Outcome, output, recording, ros, serve};

/// Everything that a run needs.
pub(super) struct Job<'a> {
    pub(super) cli: &'a Cli,
    pub(super) bars: &'a MultiProgress,
    /// Raised by the first signal.
    pub(super) stop: Arc<AtomicBool>,
    pub(super) loaded: Loaded,
    pub(super) feed: Feed,
    /// The node, when there is to be one.
    pub(super) setup: Option<Setup>,
    /// Who sends the commands when there is a node.
    pub(super) sender: Sender,
    /// The live server, when there is to be one.
    pub(super) live: Option<Live>,
    /// Where to record.
    pub(super) record: Option<&'a Path>,
    /// The recording to go on with.
    pub(super) earlier: Option<Earlier>,
    /// Whether the summary is to be JSON.
    pub(super) json: bool,
}

/// Who sends the commands when there is a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sender {
    /// A rig outside.
    Outside,
    /// A rig inside the program, over the network.
    Inside,
    /// Nobody: the feed goes straight to the twin, the node shows the answers.
    Nobody,
}

/// Does it, and says what came of it.
pub(super) fn carry_out(job: Job<'_>) -> Result<Outcome, Failure> {
    let Job { cli, bars, stop, loaded, feed, setup, sender, live, record, earlier, json } = job;
    record.map(recording::reserve).transpose()?;
    let specimen = match &earlier {
        Some(earlier) => Specimen { pack: earlier.pack(&loaded)?, prepared: Vec::new() },
        None => specimen::build(&loaded, cli.threads(), bars)?,
    };
    let pack = &specimen.pack;
    let mut orders = Orders::new(feed, &loaded, &pack.bounds)?;
    let whereabouts = orders.whereabouts();
    let mut twin = Twin::new(&loaded.scene, pack, cli.threads())?;
    let mut summary = Summary::new(&loaded, &specimen);
    tracing::info!("{} commands for {} grains", orders.length(), pack.grains.len());
    if let Some(earlier) = &earlier {
        let progress = Progress::new(None, bars);
        let mut sinks: Vec<Box<dyn Sink + '_>> =
            vec![Box::new(whereabouts.clone()), Box::new(&mut summary), Box::new(progress)];
        let from_outside = setup.is_some() && sender == Sender::Outside;
        let mut expected = (!from_outside).then(|| orders.iter());
        earlier.catch_up(&loaded, &mut twin, expected.as_mut(), &mut sinks)?;
    }
    let mut recording = match (record, &earlier) {
        (Some(folder), _) => Some(Recording::start(folder, &loaded, pack, twin.threads(), &stop)?),
        (None, Some(earlier)) => Some(earlier.go_on(&loaded, pack, twin.threads(), &stop)?),
        (None, None) => None,
    };
    let broken = Broken::default();
    let mut link = None;
    let painter = Painter::new(&loaded.scene, &pack.bounds, pack.grains.len());
    let mut live = live;
    let shown = live.as_mut().map(|live| live.sink(painter.clone())).transpose()?;
    let (mut orders, length) = match setup.map(|setup| ros::drawn_by(setup, painter)) {
        None => {
            let length = orders.length();
            (Some(orders), Some(length))
        }
        Some(setup) if sender == Sender::Nobody => {
            link = Some(Link::showing(&loaded.scene, setup, &stop)?);
            let length = orders.length();
            (Some(orders), Some(length))
        }
        Some(setup) => {
            let started = Link::start(&loaded.scene, setup, orders, sender, &stop)?;
            let length = started.length();
            link = Some(started);
            (None, length)
        }
    };
    if let Some(link) = &mut link {
        link.diagnose(&loaded.scene, recording.as_ref().map(Recording::handle));
    }
    let served = {
        // Who makes the next command must have heard of the last one first.
        let mut sinks: Vec<Box<dyn Sink + '_>> = vec![Box::new(whereabouts)];
        sinks.extend(link.as_ref().map(Link::sink));
        sinks.extend(shown);
        sinks.extend(recording.as_mut().map(|recording| Box::new(recording) as Box<dyn Sink>));
        sinks.push(Box::new(&mut summary));
        sinks.push(Box::new(Progress::new(length, bars)));
        let started = match earlier {
            Some(_) => Ok(()),
            None => serve::start(&mut twin, loaded.scene.outputs, &mut sinks),
        };
        started.map(|()| {
            let how = (loaded.scene.outputs, loaded.scene.node.late);
            let mut source = match (orders.take(), &mut link) {
                (Some(orders), _) => orders.into_source(&broken),
                (None, Some(link)) => link.commands(),
                (None, None) => return,
            };
            serve::serve(&mut twin, how, source.as_mut(), &mut sinks, &stop);
        })
    };
    if let Some(link) = link {
        link.end_into(&mut summary);
    }
    if let Some(live) = live {
        live.end();
    }
    if let Some(recording) = recording {
        recording.end(&twin, &mut summary);
    }
    served?;
    if let Some(failure) = broken.into_inner() {
        return Err(failure);
    }
    summary.ends(&mut twin, loaded.scene.outputs);
    output::print(&if json { summary.json()? } else { summary.table() })?;
    Ok(if summary.complete() { Outcome::Done } else { Outcome::Incomplete })
}
