use proptest::prelude::*;

use super::*;
use crate::node::parameters::Kind;

fn values_for(node: &str, text: &str) -> Vec<(String, Value)> {
    let all = parse_file(text, Path::new("p.yaml"), node).unwrap();
    all.into_iter().map(|one| (one.name, one.value)).collect()
}

fn refusal(text: &str) -> String {
    parse_file(text, Path::new("p.yaml"), "/graintwin").unwrap_err().to_string()
}

#[test]
fn a_file_gives_a_node_what_stands_under_its_name_and_under_wildcards_in_order() {
    let text = "\
/**:
  ros__parameters:
    merge: true
    limits: {travel: 1.0e-3, clamp: yes}
graintwin:
  ros__parameters: {merge: false}
lab:
  graintwin:
    ros__parameters:
      stale_after: 1.5
  /*/other:
    ros__parameters: {stale_after: 2.5}
/lab/*: {ros__parameters: {scene: \"1\"}}
/other: {ros__parameters: {seed: 3}}
";
    let every = [
        ("merge".to_owned(), Value::Bool(true)),
        ("limits.travel".to_owned(), Value::Double(1e-3)),
        ("limits.clamp".to_owned(), Value::Bool(true)),
    ];
    let with = |more: &[(&str, Value)]| {
        let more = more.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
        every.iter().cloned().chain(more).collect::<Vec<_>>()
    };
    assert_eq!(values_for("/a/b/c", text), every);
    assert_eq!(values_for("/graintwin", text), with(&[("merge", Value::Bool(false))]));
    let lab = [("stale_after", Value::Double(1.5)), ("scene", Value::Text("1".into()))];
    assert_eq!(values_for("/lab/graintwin", text), with(&lab));
    assert_eq!(values_for("/lab/x/other", text), with(&[("stale_after", Value::Double(2.5))]));
    assert_eq!(values_for("/other", text), with(&[("seed", Value::Integer(3))]));
}

#[test]
fn every_value_knows_its_file_and_line() {
    let text = "# a comment\n/**:\n  ros__parameters:\n    merge: true\n\n    seed: 1\n";
    let all = parse_file(text, Path::new("dir/p.yaml"), "/n").unwrap();
    let origins: Vec<&str> = all.iter().map(|one| one.origin.as_str()).collect();
    assert_eq!(origins, ["dir/p.yaml:4", "dir/p.yaml:6"]);
}

#[test]
fn a_file_that_is_none_is_refused_with_its_line() {
    for (text, told) in [
        ("ros__parameters: {a: 1}", "p.yaml:1: ros__parameters stands outside of a node"),
        ("a:\n  b: 1\n", "p.yaml:2: a single value or a list stands here"),
        ("/**:\n  ros__parameters:\n    a: [1, true]\n", "p.yaml:3: a: a list of several types"),
        ("/**:\n  ros__parameters:\n    a: [{b: 1}]\n", "p.yaml:3: a: a list of more than"),
        ("/**:\n  ros__parameters:\n    a:\n    b: 1\n", "p.yaml:3: a: no value stands here"),
        ("/**:\n  ros__parameters: 3\n", "p.yaml:2: ros__parameters holds keys with values"),
        ("/**: {\n", "p.yaml:"),
    ] {
        let refused = refusal(text);
        assert!(refused.starts_with(told), "{refused}");
    }
    assert!(values_for("/n", "").is_empty());
    assert!(values_for("/n", "/**: {ros__parameters: }").is_empty());
}

#[test]
fn values_of_the_command_line_have_the_types_of_yaml() {
    for (rule, expected) in [
        ("a:=true", Value::Bool(true)),
        ("a:=off", Value::Bool(false)),
        ("a:=12", Value::Integer(12)),
        ("a:=-1.5e-3", Value::Double(-1.5e-3)),
        ("a:=.inf", Value::Double(f64::INFINITY)),
        ("a:='12'", Value::Text("12".into())),
        ("a:=b:=c", Value::Text("b:=c".into())),
        ("a:=[1, 2]", Value::Other(Kind::INTEGER_ARRAY)),
    ] {
        let Source::One { nodes, name, value } = parse_rule(rule).unwrap() else { unreachable!() };
        assert!(nodes.hold("/any/node"));
        assert_eq!((name.as_str(), value), ("a", expected), "{rule}");
    }
    let Source::One { nodes, name, .. } = parse_rule("twin:limits.travel:=1.0").unwrap() else {
        unreachable!()
    };
    assert_eq!(name, "limits.travel");
    assert!(nodes.hold("/twin") && !nodes.hold("/other") && !nodes.hold("/lab/twin"));
}

#[test]
fn a_rule_for_a_parameter_that_is_none_is_refused() {
    for rule in ["a", ":=1", "a..b:=1", "a b:=1", "a:=", "a:={b: 1}", "a:=[", "1n:a:=1"] {
        let refused = parse_rule(rule).unwrap_err();
        assert!(!refused.is_empty(), "{rule}");
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let sources = [Source::File("no/such/file.yaml".into())];
    let told = read(&sources, &Identity::default()).unwrap_err().to_string();
    assert!(told.starts_with("no/such/file.yaml: "), "{told}");
}

proptest! {
    #[test]
    fn no_text_panics(text in "([/*a-c_: {}\\[\\],\n\"'&!|>-]|ros__parameters|: |\n  ){0,40}") {
        parse_file(&text, Path::new("p.yaml"), "/a").ok();
        parse_rule(&text).ok();
    }

    #[test]
    fn any_text_is_parsed_or_refused(text in any::<String>()) {
        parse_file(&text, Path::new("p.yaml"), "/a").ok();
        parse_rule(&text).ok();
    }

    /// The definition of the wildcards, tried one part at a time.
    #[test]
    fn wildcards_fit_as_defined(
        pattern in prop::collection::vec(prop::sample::select(vec!["a", "b", "*", "**"]), 0..6),
        name in prop::collection::vec(prop::sample::select(vec!["a", "b"]), 0..6),
    ) {
        fn fits(pattern: &[&str], name: &[&str]) -> bool {
            match pattern.split_first() {
                None => name.is_empty(),
                Some((&"**", rest)) => (0..=name.len()).any(|taken| fits(rest, &name[taken..])),
                Some((first, rest)) => name.split_first().is_some_and(|(part, others)| {
                    (*first == "*" || first == part) && fits(rest, others)
                }),
            }
        }
        let nodes = Nodes::new(&format!("/{}", pattern.join("/")));
        prop_assert_eq!(nodes.hold(&format!("/{}", name.join("/"))), fits(&pattern, &name));
    }
}
