use crate::discs::*;

#[test]
fn a_pack_is_compressed() {
    let t = std::time::Instant::now();
    let (mut rig, _) = Rig::new(&sand("none"), &loose(20, 50, 1, 0.0));
    let m = rig.stress([1e5; 2]);
    println!("{:?} {:?} {:?}", t.elapsed(), m.state, m.walls);
    println!("{:?}", rig.twin.effort());
}
