use std::collections::BTreeSet;
use std::path::Path;

use proptest::prelude::*;

use super::*;

fn store() -> Parameters {
    let scene = "pack: {file: a.csv}\nname: beads\nnode: {stale_after: 0.5}\n";
    Parameters::new(&crate::scene::parse(scene, Path::new("a.yaml")).unwrap(), 3)
}

fn set(store: &Parameters, wanted: &[(&str, Value)]) -> Result<(), Refusal> {
    let wanted: Vec<_> =
        wanted.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    store.set(&wanted)
}

#[test]
fn the_store_tells_what_the_scene_says() {
    let store = store();
    assert_eq!(store.get("scene"), Some(Value::Text("beads".into())));
    assert_eq!(store.get("seed"), Some(Value::Integer(0)));
    assert_eq!(store.get("solver.threads"), Some(Value::Integer(3)));
    assert_eq!(store.get("solver.method"), Some(Value::Text("newton".into())));
    assert_eq!(store.get("stale_after"), Some(Value::Double(0.5)));
    assert_eq!(store.get("solver.tolerance"), Some(Value::Double(1e-8)));
    assert_eq!(store.get("nothing"), None);
}

#[test]
fn names_are_sorted_and_each_is_there_once_with_a_description() {
    let names: Vec<&str> = all().iter().map(|one| one.name).collect();
    let sorted: Vec<&str> = BTreeSet::from_iter(names.iter().copied()).into_iter().collect();
    assert_eq!(names, sorted);
    assert!(all().iter().all(|one| !one.description.is_empty()));
}

#[test]
fn a_set_is_taken_as_a_whole_or_not_at_all() {
    let store = store();
    let changes = store.changes();
    let before = store.live();
    let wanted = [("merge", Value::Bool(true)), ("limits.travel", Value::Double(-1.0))];
    let told = set(&store, &wanted).unwrap_err().to_string();
    assert_eq!(told, "limits.travel cannot be -1.0: a number at least 0.0 is allowed");
    assert_eq!(store.live(), before);
    assert_eq!(changes.take(), None);

    let wanted = [("merge", Value::Bool(true)), ("limits.travel", Value::Double(1e-3))];
    set(&store, &wanted).unwrap();
    let seen = changes.take().unwrap();
    assert!(seen.merge && seen.limits.travel == 1e-3);
    assert_eq!(seen, store.live());
    assert_eq!(changes.take(), None, "a change is told once");
}

#[test]
fn what_cannot_be_set_is_refused_in_a_sentence() {
    for (name, value, told) in [
        (
            "stale_after",
            Value::Integer(1),
            "stale_after is of type double, not integer: write it with",
        ),
        ("merge", Value::Text("yes".into()), "merge is of type bool, not string"),
        ("merge", Value::Other(Kind::NOT_SET), "merge cannot be removed"),
        ("merge", Value::Other(Kind(77)), "not unknown (77)"),
        ("seed", Value::Integer(1), "seed is read-only"),
        ("use_sim_time", Value::Bool(true), "use_sim_time is read-only while the node runs"),
        ("view.scale", Value::Double(2.0), "view.scale is read-only while the node runs"),
        ("scene", Value::Text("a".into()), "scene is read-only"),
        ("limits", Value::Double(1.0), "there is no parameter `limits`: there are limits.clamp,"),
        ("stale_after", Value::Double(f64::NAN), "cannot be NaN"),
        ("stale_after", Value::Double(f64::INFINITY), "cannot be inf"),
        ("solver.tolerance", Value::Double(0.1), "at least 1e-13 and at most 0.01 is allowed"),
        ("solver.max_strain_increment", Value::Double(0.0), "above 0.0 and at most 0.1"),
    ] {
        let refused = set(&store(), &[(name, value)]).unwrap_err().to_string();
        assert!(refused.contains(told), "{refused}");
    }
}

#[test]
fn values_at_the_start_are_none_that_the_solver_is_told_of_as_changes() {
    let store = store();
    let one = |name: &str, value| Override {
        name: name.into(),
        value,
        origin: format!("p.yaml:{}", name.len()),
    };
    let given = [
        one("merge", Value::Bool(true)),
        one("a", Value::Bool(true)),
        one("merge", Value::Bool(false)),
    ];
    let told = store.start_with(&given).unwrap();
    assert_eq!(told.len(), 1);
    assert!(told[0].starts_with("p.yaml:1: there is no parameter `a`: there are "), "{told:?}");
    assert!(!store.live().merge, "the later value counts");
    assert_eq!(store.start_with(&[one("use_sim_time", Value::Bool(true))]), Ok(Vec::new()));
    assert!(store.live().use_sim_time);
    assert_eq!(store.start_with(&[one("view.scale", Value::Double(250.0))]), Ok(Vec::new()));
    let mut scene = crate::scene::parse("pack: {file: a.csv}", Path::new("a.yaml")).unwrap();
    store.live().write_to(&mut scene);
    assert_eq!(scene.view.scale, crate::scene::Choice::Given(250.0));
    assert_eq!(store.start_with(&[one("view.scale", Value::Double(0.0))]), Ok(Vec::new()));
    store.live().write_to(&mut scene);
    assert_eq!(scene.view.scale, crate::scene::Choice::Auto);
    assert_eq!(store.changes().take(), None);
    let bad = store.start_with(&[one("merge", Value::Integer(1))]).unwrap_err().to_string();
    assert_eq!(bad, "p.yaml:5: merge is of type bool, not integer");
}

#[test]
fn the_scene_gets_what_it_has_keys_for() {
    let store = store();
    let mut scene = crate::scene::parse("pack: {file: a.csv}", Path::new("a.yaml")).unwrap();
    let wanted =
        [("stale_after", 2.0), ("solver.tolerance", 1e-6), ("solver.max_strain_increment", 1e-3)];
    set(&store, &wanted.map(|(name, value)| (name, Value::Double(value)))).unwrap();
    store.live().write_to(&mut scene);
    assert_eq!(scene.node.stale_after, 2.0);
    assert_eq!(scene.solver.tolerance, 1e-6);
    assert_eq!(scene.solver.max_strain_increment, 1e-3);
}

#[test]
fn names_are_listed_by_prefix_and_depth_as_other_nodes_list_them() {
    let listed = |prefixes: &[&str], depth| {
        list(&prefixes.iter().map(|&prefix| prefix.to_owned()).collect::<Vec<_>>(), depth)
    };
    let (names, above) = listed(&[], 0);
    assert_eq!(names.len(), all().len());
    assert_eq!(above, ["limits", "solver", "view"]);
    assert!(listed(&[], 1).0.iter().all(|name| !name.contains('.')));
    assert_eq!(listed(&["solver"], 0).0.len(), 4);
    assert_eq!(listed(&["solver"], 1).0, Vec::<&str>::new());
    assert_eq!(listed(&["solver"], 2).0, listed(&["solver"], 0).0);
    assert_eq!(listed(&["merge"], 1).0, ["merge"]);
    assert_eq!(listed(&["mer", "limit"], 0).0, Vec::<&str>::new());
}

fn value() -> impl Strategy<Value = Value> {
    prop_oneof![
        any::<bool>().prop_map(Value::Bool),
        any::<i64>().prop_map(Value::Integer),
        any::<f64>().prop_map(Value::Double),
        (0.0..1e-2).prop_map(Value::Double),
        any::<String>().prop_map(Value::Text),
        any::<u8>().prop_map(|kind| Value::Other(Kind(kind))),
    ]
}

fn name() -> impl Strategy<Value = String> {
    let names = all().iter().map(|one| one.name.to_owned()).collect::<Vec<_>>();
    prop_oneof![9 => prop::sample::select(names), 1 => any::<String>()]
}

proptest! {
    #[test]
    fn whatever_is_set_the_values_stay_those_a_scene_allows(
        sets in prop::collection::vec(prop::collection::vec((name(), value()), 1..4), 1..20),
    ) {
        let store = store();
        for wanted in sets {
            let before = store.live();
            match store.set(&wanted) {
                Ok(()) => for (name, _) in &wanted {
                    let last = wanted.iter().rfind(|(other, _)| other == name).unwrap();
                    prop_assert_eq!(store.get(name), Some(last.1.clone()));
                },
                Err(_) => prop_assert_eq!(store.live(), before),
            }
        }
        let mut scene = crate::scene::parse("pack: {file: a.csv}", Path::new("a.yaml")).unwrap();
        store.live().write_to(&mut scene);
        let echoed = scene.to_yaml().unwrap();
        prop_assert!(crate::scene::parse(&echoed, Path::new("a.yaml")).is_ok(), "{}", echoed);
    }
}
