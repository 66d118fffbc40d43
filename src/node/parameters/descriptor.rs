//! What each parameter means and takes.

use std::fmt;

use super::{Kind, Live, Refusal, Value};
use crate::scene::{MAX_STRAIN_INCREMENT, Scene, TOLERANCE, VIEW_SCALE};

/// A parameter.
#[derive(Debug)]
pub struct Descriptor {
    /// Name; dots part it.
    pub name: &'static str,
    /// What it means, with its unit.
    pub description: &'static str,
    /// Where its value is.
    pub field: Field,
}

/// Where the value of a parameter is, and thereby its type.
#[derive(Debug)]
pub enum Field {
    /// Read-only text.
    Text(fn(&Fixed) -> &str),
    /// A read-only number.
    Count(fn(&Fixed) -> i64),
    /// A number that can be set.
    Double(fn(&mut Live) -> &mut f64, Range),
    /// A switch.
    Bool(fn(&mut Live) -> &mut bool),
    /// A number that is read-only once the node runs.
    DoubleAtStart(fn(&mut Live) -> &mut f64, Range),
    /// A switch that is read-only once the node runs.
    AtStart(fn(&mut Live) -> &mut bool),
}

/// The numbers that a parameter takes; all of them are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least.
    pub from: f64,
    /// Whether `from` itself is out.
    pub above: bool,
    /// Largest.
    pub to: f64,
}

impl Range {
    const AT_LEAST_ZERO: Self = Self { from: 0.0, above: false, to: f64::MAX };

    fn holds(&self, value: f64) -> bool {
        (self.from..=self.to).contains(&value) && !(self.above && value == self.from)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let low = if self.above { "above" } else { "at least" };
        write!(to, "a number {low} {:?}", self.from)?;
        if self.to < f64::MAX { write!(to, " and at most {:?}", self.to) } else { Ok(()) }
    }
}

/// What does not change while the twin runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fixed {
    scene: String,
    method: &'static str,
    seed: i64,
    threads: i64,
}

impl Fixed {
    pub(super) fn of(scene: &Scene, threads: usize) -> Self {
        let seed = scene.pack.generate.as_ref().map_or(scene.pack.seed, |generate| generate.seed);
        Self {
            scene: scene.name.clone(),
            method: scene.solver.method.name(),
            // A seed beyond 63 bits keeps its bits.
            seed: seed as i64,
            threads: i64::try_from(threads).unwrap_or(i64::MAX),
        }
    }
}

impl Descriptor {
    /// Its type.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self.field {
            Field::Text(_) => Kind::STRING,
            Field::Count(_) => Kind::INTEGER,
            Field::Double(..) | Field::DoubleAtStart(..) => Kind::DOUBLE,
            Field::Bool(_) | Field::AtStart(_) => Kind::BOOL,
        }
    }

    /// Whether it only tells, once the node runs.
    #[must_use]
    pub fn read_only(&self) -> bool {
        self.tells() || self.at_start()
    }

    /// Whether it only tells, from the start.
    #[must_use]
    pub fn tells(&self) -> bool {
        matches!(self.field, Field::Text(_) | Field::Count(_))
    }

    /// Whether it can be set, but not once the node runs.
    pub(super) fn at_start(&self) -> bool {
        matches!(self.field, Field::AtStart(_) | Field::DoubleAtStart(..))
    }

    pub(super) fn get(&self, live: &Live, fixed: &Fixed) -> Value {
        let mut live = *live;
        match self.field {
            Field::Text(field) => Value::Text(field(fixed).into()),
            Field::Count(field) => Value::Integer(field(fixed)),
            Field::Double(field, _) | Field::DoubleAtStart(field, _) => {
                Value::Double(*field(&mut live))
            }
            Field::Bool(field) | Field::AtStart(field) => Value::Bool(*field(&mut live)),
        }
    }

    pub(super) fn set(&self, live: &mut Live, value: &Value) -> Result<(), Refusal> {
        let name = self.name;
        match (&self.field, value) {
            (Field::Text(_) | Field::Count(_), _) => return Err(Refusal::ReadOnly { name }),
            (_, Value::Other(Kind::NOT_SET)) => return Err(Refusal::Removal { name }),
            (
                Field::Double(field, range) | Field::DoubleAtStart(field, range),
                Value::Double(value),
            ) => {
                if !range.holds(*value) {
                    return Err(Refusal::Outside { name, found: *value, range: *range });
                }
                *field(live) = *value;
            }
            (Field::Bool(field) | Field::AtStart(field), Value::Bool(value)) => {
                *field(live) = *value;
            }
            _ => {
                return Err(Refusal::Kind { name, needed: self.kind(), found: value.kind() });
            }
        }
        Ok(())
    }
}

/// Every parameter, by name.
#[must_use]
pub fn all() -> &'static [Descriptor] {
    &ALL
}

static ALL: [Descriptor; 16] = [
    Descriptor {
        name: "limits.clamp",
        description: "Whether a command beyond a limit is served up to the limit (true) or refused",
        field: Field::Bool(|live| &mut live.limits.clamp),
    },
    Descriptor {
        name: "limits.force",
        description: "Largest normal force on a wall [N]; 0 = no limit",
        field: Field::Double(|live| &mut live.limits.force, Range::AT_LEAST_ZERO),
    },
    Descriptor {
        name: "limits.rate",
        description: "Largest speed of a wall by the stamps of the commands [m/s]; 0 = no limit",
        field: Field::Double(|live| &mut live.limits.rate, Range::AT_LEAST_ZERO),
    },
    Descriptor {
        name: "limits.strain",
        description: "Largest strain of the specimen since the start, along any axis; 0 = no limit",
        field: Field::Double(|live| &mut live.limits.strain, Range::AT_LEAST_ZERO),
    },
    Descriptor {
        name: "limits.travel",
        description: "Largest displacement of a wall since the start [m]; 0 = no limit",
        field: Field::Double(|live| &mut live.limits.travel, Range::AT_LEAST_ZERO),
    },
    Descriptor {
        name: "merge",
        description: "Whether absolute commands are merged into one path when the rig is faster",
        field: Field::Bool(|live| &mut live.merge),
    },
    Descriptor {
        name: "scene",
        description: "Name of the scene",
        field: Field::Text(|fixed| &fixed.scene),
    },
    Descriptor {
        name: "seed",
        description: "Seed that the pack was made with",
        field: Field::Count(|fixed| fixed.seed),
    },
    Descriptor {
        name: "solver.max_strain_increment",
        description: "Largest strain between two equilibria; larger commands are sub-stepped",
        field: Field::Double(
            |live| &mut live.max_strain_increment,
            Range { from: 0.0, above: true, to: MAX_STRAIN_INCREMENT },
        ),
    },
    Descriptor {
        name: "solver.method",
        description: "Relaxation method",
        field: Field::Text(|fixed| fixed.method),
    },
    Descriptor {
        name: "solver.threads",
        description: "Threads that the solver works on",
        field: Field::Count(|fixed| fixed.threads),
    },
    Descriptor {
        name: "solver.tolerance",
        description: "Largest unbalanced force of a grain over the mean contact force",
        field: Field::Double(
            |live| &mut live.tolerance,
            Range { from: *TOLERANCE.start(), above: false, to: *TOLERANCE.end() },
        ),
    },
    Descriptor {
        name: "stale_after",
        description: "Age beyond which a command is refused [s]; 0 = never",
        field: Field::Double(|live| &mut live.stale_after, Range::AT_LEAST_ZERO),
    },
    Descriptor {
        name: "use_sim_time",
        description: "Whether the age of a command is counted on the time of /clock",
        field: Field::AtStart(|live| &mut live.use_sim_time),
    },
    Descriptor {
        name: "version",
        description: "Version of the program",
        field: Field::Text(|_| env!("CARGO_PKG_VERSION")),
    },
    Descriptor {
        name: "view.scale",
        description: "Size of the pictures on ~/grains and ~/markers over that of the specimen; \
                      0 = the power of ten that makes the box about 1 m",
        field: Field::DoubleAtStart(
            |live| &mut live.view_scale,
            Range { from: 0.0, above: false, to: VIEW_SCALE },
        ),
    },
];
