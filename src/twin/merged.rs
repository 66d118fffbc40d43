//! Several commands as one increment.

use super::Twin;
use crate::command::Command;
use crate::command::gate::{Decision, Order, join};
use crate::report::{Demand, Report};

/// How several commands were served.
#[derive(Debug)]
pub enum Merged {
    /// The first of them in one increment; their reports, at least two.
    Together(Vec<Report>),
    /// Not at all: this many of the first have to be served one by one, at least one.
    Apart(usize),
}

impl Twin {
    /// Serves in one increment the first of `commands`, as many as the gate would serve in full
    /// one by one. They must be such that [`mergeable`](crate::command::merge::mergeable) counts
    /// them.
    ///
    /// The walls go straight to the last one's target. Its report has the measures, those of the
    /// others name it. When there is no equilibrium within the limits on the straight way, nothing
    /// has changed.
    pub fn apply_merged(&mut self, commands: &[Command], demand: Demand) -> Merged {
        let orders = self.orders(commands);
        let commands = &commands[..orders.len()];
        let ([first, .., last], Some(last_order)) = (commands, orders.last()) else {
            return Merged::Apart(1);
        };
        let gone = self.go(last_order, false);
        if !gone.is_whole() {
            return Merged::Apart(orders.len());
        }
        let note = format!("{} commands merged, from sequence {} on", orders.len(), first.sequence);
        let order = Order { text: join(&last_order.text, &note), ..last_order.clone() };
        let reached = self.conclude(last, order, gone, demand);
        let merged = commands.iter().zip(&orders).take(orders.len() - 1).map(|(command, order)| {
            let text = join(&order.text, &format!("merged into sequence {}", last.sequence));
            Report { text, ..self.blank(command) }
        });
        let mut reports: Vec<Report> = merged.collect();
        reports.push(reached);
        Merged::Together(reports)
    }

    /// What the gate would let the first of `commands` do one by one, as long as it is in full.
    fn orders(&self, commands: &[Command]) -> Vec<Order> {
        let mut gate = self.gate.clone();
        let mut orders = Vec::new();
        for command in commands {
            match gate.decide(command) {
                Decision::Serve(order) if !order.clamped => {
                    gate.expect(command, &order);
                    orders.push(order);
                }
                _ => break,
            }
        }
        orders
    }
}
