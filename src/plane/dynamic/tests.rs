use super::*;
use crate::pack::{Grain, Pack};
use crate::plane::work::Drive;
use crate::scene::{self, Scene};
use crate::wall::{Bounds, Load};

/// Radius \[m\] and stiffness of the contacts \[N/m\].
const R: f64 = 1e-4;
const STIFFNESS: f64 = 1e6;

fn scene(walls: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{friction: 0.0{walls}}}\ncontact: \
         {{normal: {{linear: {{stiffness: {STIFFNESS:e}}}}}, friction: {{coefficient: .inf}}}}\n"
    );
    scene::parse(&text, "motion.yaml".as_ref()).unwrap()
}

fn pack(centres: impl IntoIterator<Item = [f64; 2]>, min: [f64; 2], max: [f64; 2]) -> Pack {
    let disc = |[x, y]: [f64; 2]| Grain {
        position: [x, y, 0.0],
        radius: R,
        young: 2.32e9,
        poisson: 0.16,
        density: 2650.0,
        friction: f64::INFINITY,
        hydrate: false,
    };
    let bounds = Bounds { min: [min[0], min[1], -R], max: [max[0], max[1], R] };
    Pack { bounds, grains: centres.into_iter().map(disc).collect(), history: None }
}

/// A pack in motion, every contact as it is at the start.
struct Moving {
    model: Model,
    state: State,
    work: Workspace,
    near: Neighbours,
    inertia: Inertia,
}

impl Moving {
    fn new(scene: &Scene, pack: &Pack) -> Self {
        let model = Model::new(pack, scene);
        let mut state = State::new(&model);
        let (mut work, mut near) = (Workspace::default(), Neighbours::default());
        work.begin(&model, &mut state, &mut near, true);
        let mut inertia = Inertia::default();
        inertia.halt(model.len());
        Self { model, state, work, near, inertia }
    }

    /// Takes the masses that it has from here on.
    fn weigh(&mut self) {
        let Self { model, state, work, inertia, .. } = self;
        inertia.masses.evaluate(model, state, work);
        inertia.masses.take(&work.drives, STIFFNESS);
    }

    fn step(&mut self, leap: Leap) {
        let Self { model, state, work, near, inertia } = self;
        work.refresh(model, state, near);
        inertia.masses.evaluate(model, state, work);
        inertia.step(model, state, work, leap);
    }

    /// Kinetic energy \[J\].
    fn kinetic(&self) -> f64 {
        let Inertia { masses, velocity, spin, drive } = &self.inertia;
        let grains = (0..velocity.len()).map(|i| {
            let [mass, turned] = masses.of(i);
            mass * velocity[i].norm_squared() + turned * spin[i].norm_squared()
        });
        let drives = (0..self.work.drives.len()).map(|k| masses.of_drive(k) * drive[k].x.powi(2));
        0.5 * grains.chain(drives).sum::<f64>()
    }

    /// Potential of the loads \[J\].
    fn loads(&self) -> f64 {
        let loads = self.work.drives.iter().map(|drive| {
            let way = drive.shares.iter().zip(self.state.displacement);
            -drive.force * way.map(|(share, way)| share * way).sum::<f64>()
        });
        loads.sum()
    }
}

/// Three rows of three in a box whose top carries a load, with places a little off.
fn shaken() -> Moving {
    let pitch = 2.0 * R * (1.0 - 1e-3);
    let wave = |k: usize| (2.7 * k as f64).sin() * 2e-5 * R;
    let at =
        |k: usize| [(k % 3) as f64 * pitch + R + wave(k), (k / 3) as f64 * pitch + R + wave(k + 9)];
    let side = 2.0 * pitch + 2.0 * R * (1.0 - 5e-4);
    let pack = pack((0..9).map(at), [5e-4 * R; 2], [side; 2]);
    let mut moving = Moving::new(&scene(""), &pack);
    let force = 3.0 * STIFFNESS * 2e-3 * R;
    moving.work.drives.push(Drive {
        shares: [0.0, 0.0, 0.0, 1.0],
        force,
        load: Load::Force(force),
    });
    moving.weigh();
    moving
}

#[test]
fn without_damping_energy_stays_to_the_square_of_the_time_step() {
    let errors = [0.08, 0.04].map(|dt| {
        let mut moving = shaken();
        let (mut energies, mut before) = (Vec::new(), 0.0);
        let mut most = 0.0_f64;
        for _ in 0..(40.0 / dt) as usize {
            let loads = moving.loads();
            moving.step(Leap { dt, damping: 0.0 });
            // The balance is that of the place between two half steps of the velocity.
            let (kinetic, potential) = (moving.kinetic(), moving.work.balance.potential());
            energies.push(loads + potential + 0.5 * (before + kinetic));
            most = most.max(kinetic);
            before = kinetic;
        }
        let first = energies[1];
        assert!(most > 0.0);
        energies[1..].iter().map(|e| (e - first).abs()).fold(0.0, f64::max) / most
    });
    let [coarse, fine] = errors;
    assert!(coarse < 0.02 && (3.0..5.0).contains(&(coarse / fine)), "{errors:?}");
}

#[test]
fn momentum_stays_where_nothing_pushes_from_outside() {
    // A triangle that flies and turns, its contacts in shear and pressed.
    let rise = 3.0_f64.sqrt() * R;
    let at = [[-R, 0.0], [R, 0.0], [1e-3 * R, 0.999 * rise]];
    let far = [30.0 * R; 2];
    let mut moving = Moving::new(&scene(""), &pack(at, far.map(|x| -x), far));
    moving.weigh();
    for (i, v) in [[1.0, 0.3], [0.9, 0.5], [1.1, 0.2]].iter().enumerate() {
        moving.inertia.velocity[i] = Vec2::new(v[0], v[1]) * (2e-4 * R);
        moving.inertia.spin[i].x = 1e-4 * R * (i as f64 - 0.7);
    }
    let momenta = |moving: &Moving| {
        let Inertia { masses, velocity, spin, .. } = &moving.inertia;
        let (mut along, mut around, mut spins) = (Vec2::zeros(), 0.0, 0.0);
        for i in 0..3 {
            let [mass, turned] = masses.of(i);
            along += velocity[i] * mass;
            around += moving.work.pose.at[i].perp(&(velocity[i] * mass)) + R * turned * spin[i].x;
            spins += R * turned * spin[i].x;
        }
        (along, around, spins)
    };
    let (along, around, spins) = momenta(&moving);
    for _ in 0..200 {
        moving.step(Leap { dt: 0.5, damping: 0.0 });
    }
    let (now, now_around, now_spins) = momenta(&moving);
    assert!((now - along).norm() < 1e-12 * along.norm(), "{along} {now}");
    assert!((now_around - around).abs() < 1e-10 * around.abs(), "{around:e} {now_around:e}");
    // Between the parts it goes to and fro.
    assert!((now_spins - spins).abs() > 0.1 * spins.abs(), "{spins:e} {now_spins:e}");
}

#[test]
fn local_damping_takes_the_same_share_of_every_swing() {
    // While k(1 - α) drives a swing, k(1 + α) brakes it: ½ k (1 - α) A² = ½ k (1 + α) B².
    let damping = 0.4_f64;
    let want = ((1.0 - damping) / (1.0 + damping)).sqrt();
    let half = R * (1.0 - 1e-3);
    let off = 5e-4 * R;
    let mut moving =
        Moving::new(&scene(""), &pack([[off, 0.0]], [-half, -2.0 * R], [half, 2.0 * R]));
    moving.weigh();
    let mut swings = vec![off];
    let mut last = 0.0;
    while swings.len() < 6 {
        let at = moving.work.pose.at[0].x;
        moving.step(Leap { dt: 2e-3, damping });
        let speed = moving.inertia.velocity[0].x;
        if speed * last < 0.0 {
            swings.push(at.abs());
        }
        last = speed;
    }
    for pair in swings.windows(2) {
        assert!((pair[1] / pair[0] / want - 1.0).abs() < 5e-3, "{swings:?} {want}");
    }
}
