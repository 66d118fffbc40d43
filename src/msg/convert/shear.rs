//! Simple shear as messages.

use super::pack_header;
use crate::command::{Ask, Command, Shear};
use crate::msg::{ShearCommand, ShearState};
use crate::report::{self, Measures};
use crate::wall::WallTarget;

/// A command whose age nobody has measured yet.
impl From<ShearCommand> for Command {
    fn from(message: ShearCommand) -> Self {
        let ShearCommand { tilt, control, value, .. } = message;
        let targets = std::array::from_fn(|w| WallTarget::from_numbers(control[w], value[w]));
        Self {
            stamp: message.header.stamp.into(),
            session: message.session,
            sequence: message.sequence,
            mode: message.mode.into(),
            ask: Ask::Shear(Shear { tilt, targets }),
            age: None,
        }
    }
}

/// The message of `command`, which asks for `shear`.
pub(super) fn command(command: &Command, shear: &Shear) -> ShearCommand {
    ShearCommand {
        header: pack_header(command.stamp),
        session: command.session.clone(),
        sequence: command.sequence,
        mode: command.mode.into(),
        tilt: shear.tilt,
        control: shear.targets.map(|target| target.numbers().0),
        value: shear.targets.map(|target| target.numbers().1),
    }
}

/// How the box is sheared, when that was asked for and the grains are discs.
#[must_use]
pub fn shear(measures: &Measures) -> Option<ShearState> {
    let report::Shear {
        tilt,
        strain,
        inner_stress,
        inner_grains,
        stress_direction,
        strain_direction,
        mean_rotation,
    } = measures.shear?;
    Some(ShearState {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        tilt,
        strain,
        inner_stress,
        inner_grains,
        stress_direction,
        strain_direction,
        mean_rotation,
    })
}
