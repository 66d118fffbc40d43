//! `run --resume`: going on with a recording that was broken off.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::anyhow;

use graintwin::command::request::Intake;
use graintwin::command::{Ask, Command};
use graintwin::pack::Pack;
use graintwin::record::reader::Bag;
use graintwin::record::recover::{self, Recovered};
use graintwin::record::replay::{Act, Compared, Replay, Step};
use graintwin::scene::{Loaded, Node, Scene};
use graintwin::sink::Sink;
use graintwin::twin::Twin;
use graintwin::view::picture::Painter;

use super::orders::Intakes;
use super::recording::Recording;
use super::{Failure, serve};

/// A recording that is gone on with.
pub(super) struct Earlier {
    bag: Bag,
    folder: PathBuf,
}

impl Earlier {
    /// The recording in `folder`, made whole there when it was broken off.
    pub(super) fn open(folder: &Path) -> Result<Self, Failure> {
        let recovered = recover::in_place(folder).map_err(Failure::input)?;
        if recovered.rewritten > 0 {
            let Recovered { kept, dropped, .. } = recovered;
            tracing::warn!(
                "{}: was broken off; made whole with {kept} messages, {dropped} of an answer that \
                 was cut off are left out",
                folder.display()
            );
        }
        let bag = Bag::open(folder).map_err(Failure::input)?;
        Ok(Self { bag, folder: folder.to_owned() })
    }

    /// Its scene, which relative files of are meant from the working directory.
    pub(super) fn scene(&self) -> Result<Loaded, Failure> {
        let scene = self.replay()?.scene;
        Ok(Loaded { scene, file: PathBuf::from("scene.yaml") })
    }

    /// Its pack, when `loaded` is the scene that it was made under, as far as answers go.
    pub(super) fn pack(&self, loaded: &Loaded) -> Result<Pack, Failure> {
        let replay = self.replay()?;
        match difference(&replay.scene, &loaded.scene)? {
            None => Ok(replay.pack),
            Some([recorded, given]) => Err(Failure::Input(anyhow!(
                "{}: was recorded with another scene than {}: `{recorded}` there, `{given}` here",
                self.folder.display(),
                loaded.file.display()
            ))),
        }
    }

    /// Brings `twin` to where the recording ended. Every answer must be the recorded one to the
    /// bit, and every command the next of `expected`, if there are such.
    pub(super) fn catch_up(
        &self,
        loaded: &Loaded,
        twin: &mut Twin,
        mut expected: Option<&mut Intakes<'_>>,
        sinks: &mut [Box<dyn Sink + '_>],
    ) -> Result<(), Failure> {
        let replay = self.replay()?;
        let painter = Painter::new(&replay.scene, &replay.pack.bounds, replay.pack.grains.len());
        let mut compared = Compared::default();
        for step in replay.tape() {
            let step = step.map_err(Failure::input)?;
            if let Some(expected) = &mut expected {
                self.draw(&step, expected, loaded)?;
            }
            let (mut served, said) =
                step.play(twin, serve::ordered(replay.scene.outputs, step.demand()));
            compared
                .request(&step, said.as_ref())
                .and_then(|()| compared.answers(&step, &mut served, &painter))
                .map_err(|found| {
                    let folder = self.folder.display();
                    Failure::Other(anyhow!("{folder}: cannot go on with other bits: {found}"))
                })?;
            for served in served {
                serve::give(served, sinks);
            }
        }
        if compared.answers == 0 {
            let folder = self.folder.display();
            return Err(Failure::Input(anyhow!("{folder}: holds no answer to go on from")));
        }
        Ok(())
    }

    /// Goes on recording behind it.
    pub(super) fn go_on(
        &self,
        loaded: &Loaded,
        pack: &Pack,
        threads: usize,
        stop: &Arc<AtomicBool>,
    ) -> Result<Recording, Failure> {
        Recording::resume(&self.folder, loaded, pack, threads, stop)
    }

    fn replay(&self) -> Result<Replay<'_>, Failure> {
        Replay::open(&self.bag, None).map_err(Failure::input)
    }

    /// Takes the commands of `step` out of `expected`.
    fn draw(
        &self,
        step: &Step,
        expected: &mut Intakes<'_>,
        loaded: &Loaded,
    ) -> Result<(), Failure> {
        let commands = match &step.act {
            Act::Serve(command) | Act::Refuse(command, _) => std::slice::from_ref(command),
            Act::Merge(commands) => commands,
            Act::Start | Act::Reset | Act::Happened(_) => &[],
        };
        for command in commands {
            let next = match expected.next().transpose()? {
                Some(Intake::Command(next) | Intake::Malformed(next, _)) => Some(next),
                Some(Intake::Request(_)) | None => None,
            };
            if !next.is_some_and(|next| same(&next, command)) {
                return Err(Failure::Input(anyhow!(
                    "{}: command {} of session `{}` is not the next one that {} gives: its load \
                     path or commands have changed",
                    self.folder.display(),
                    command.sequence,
                    command.session,
                    loaded.file.display()
                )));
            }
        }
        Ok(())
    }
}

/// Whether two commands ask for the same, to the bit, NaN included.
fn same(one: &Command, other: &Command) -> bool {
    let bits = |command: &Command| {
        command.ask.targets().map(|target| {
            let (kind, value) = target.numbers();
            (kind, value.to_bits())
        })
    };
    let rest = |command: &Command| {
        (command.stamp, command.session.clone(), command.sequence, u8::from(command.mode))
    };
    let dissociates = |command: &Command| match &command.ask {
        Ask::Dissociation(asked) => Some(asked.named().map(|(_, number)| number.to_bits())),
        _ => None,
    };
    let leans = |command: &Command| match &command.ask {
        Ask::Shear(shear) => Some(shear.tilt.to_bits()),
        _ => None,
    };
    bits(one) == bits(other)
        && leans(one) == leans(other)
        && dissociates(one) == dissociates(other)
        && rest(one) == rest(other)
}

/// The first line in which what bears on the answers differs between the scene of a recording and
/// another one, as they are written with all defaults.
fn difference(recorded: &Scene, other: &Scene) -> Result<Option<[String; 2]>, Failure> {
    let Scene { name, pack, load_path, outputs, record, view, .. } = recorded.clone();
    let node = Node {
        stale_after: other.node.stale_after,
        limits: other.node.limits,
        hold_after: other.node.hold_after.clone(),
        ..recorded.node.clone()
    };
    let other = Scene { name, pack, load_path, outputs, record, view, node, ..other.clone() };
    let (one, other) = (recorded.to_yaml()?, other.to_yaml()?);
    let mut lines = one.lines().zip(other.lines());
    let different = lines.find(|(one, other)| one != other);
    Ok(different.map(|(one, other)| [one, other].map(|line| line.trim().to_owned())))
}
