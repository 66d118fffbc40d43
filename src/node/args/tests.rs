use proptest::prelude::*;

use super::*;

fn line(words: &[&str]) -> Result<(Vec<OsString>, Option<RosArgs>), ArgsError> {
    split(words.iter().map(OsString::from))
}

fn group_of(words: &[&str]) -> RosArgs {
    line(&[&["--ros-args"], words].concat()).unwrap().1.unwrap()
}

fn refusal(words: &[&str]) -> String {
    line(&[&["--ros-args"], words].concat()).unwrap_err().to_string()
}

#[test]
fn groups_are_taken_out_and_the_rest_stays_in_order() {
    let (rest, taken) = line(&[
        "run",
        "a.yaml",
        "--ros-args",
        "-r",
        "a:=b",
        "--",
        "--json",
        "--ros-args",
        "-r",
        "c:=d",
    ])
    .unwrap();
    assert_eq!(rest, ["run", "a.yaml", "--json"]);
    assert_eq!(taken.unwrap().remaps.len(), 2);
    assert_eq!(
        line(&["run", "--", "x"]).unwrap(),
        (vec!["run".into(), "--".into(), "x".into()], None)
    );
    assert_eq!(line(&["--ros-args"]).unwrap().1, Some(RosArgs::default()));
}

#[test]
fn what_ros2_launch_passes_is_understood() {
    let args = group_of(&[
        "--ros-args",
        "-r",
        "__node:=twin",
        "-r",
        "__ns:=/lab",
        "--params-file",
        "dir/p.yaml",
        "-p",
        "use_sim_time:=true",
        "--remap",
        "~/state:=/state",
        "--log-level",
        "DEBUG",
        "--log-level",
        "rustdds.rtps:=Fatal",
        "--disable-stdout-logs",
        "--disable-rosout-logs",
        "--enable-external-lib-logs",
        "-e",
        "/",
    ]);
    let kinds: Vec<_> = args.remaps.iter().map(|rule| rule.kind.clone()).collect();
    assert_eq!(kinds[0], RemapKind::Node("twin".into()));
    assert_eq!(kinds[1], RemapKind::Namespace("/lab".into()));
    assert_eq!(kinds[2], RemapKind::Name { from: "~/state".into(), to: "/state".into() });
    assert_eq!(args.parameters[0], Source::File("dir/p.yaml".into()));
    assert_eq!(args.parameters.len(), 2);
    assert_eq!(args.log.level, Some(Severity::Debug));
    assert_eq!(args.log.loggers, [("rustdds.rtps".to_owned(), Severity::Fatal)]);
    assert!(!args.log.console && !args.log.rosout);
    assert!(args.ignored.is_empty(), "{:?}", args.ignored);
}

#[test]
fn what_is_not_known_is_told_and_does_no_harm() {
    let args = group_of(&["--new-thing", "stray", "--enclave", "/lab", "-r", "a:=b"]);
    assert_eq!(args.remaps.len(), 1);
    assert_eq!(args.ignored.len(), 3);
    assert_eq!(args.ignored[0], "--new-thing after --ros-args is not known here and is ignored");
}

#[test]
fn a_rule_that_is_none_is_refused_with_what_is_allowed() {
    for (words, told) in [
        (&["-r"][..], "-r is the last argument of --ros-args: FROM:=TO must follow it"),
        (&["-r", "ab"], "-r ab: a rule reads FROM:=TO, with := between"),
        (&["-r", "__node:=a/b"], "`a/b` is no name of a node"),
        (&["-r", "__node:=1a"], "`1a` is no name of a node"),
        (&["-r", "__ns:=lab"], "`lab` is no namespace: / or /a/b is allowed"),
        (&["-r", "__ns:=/lab/"], "`/lab/` is no namespace"),
        (&["-r", "a b:=c"], "`a b` is no name of a topic or service"),
        (&["-r", "/a/*:=c"], "wildcards are not known"),
        (&["-r", "rostopic://a:=c"], "rostopic:// is not known here"),
        (&["-r", "1x:a:=c"], "`1x` is no name of a node"),
        (&["-p", "merge"], "NAME:=VALUE"),
        (&["--log-level", "loud"], "`loud` is no level"),
        (&["--log-level", ":=info"], "the logger's name must be"),
        (&["--params-file"], "a file must follow it"),
    ] {
        let refused = refusal(words);
        assert!(refused.contains(told), "{refused}");
    }
}

#[cfg(unix)]
#[test]
fn bytes_that_are_no_text_are_passed_on_outside_and_told_inside() {
    use std::os::unix::ffi::OsStringExt;
    let bytes = || OsString::from_vec(vec![0xff, 0x61]);
    let (rest, taken) =
        split([bytes(), "--ros-args".into(), bytes(), "--params-file".into(), bytes()]).unwrap();
    assert_eq!(rest, [bytes()]);
    let taken = taken.unwrap();
    assert_eq!(taken.ignored.len(), 1);
    assert_eq!(taken.parameters, [Source::File(bytes().into())]);
    assert!(split(["--ros-args".into(), "-r".into(), bytes()]).is_err());
}

/// Words like those of a command line, mangled.
fn word() -> impl Strategy<Value = String> {
    let known = prop::sample::select(vec![
        "--ros-args",
        "--",
        "-r",
        "-p",
        "--remap",
        "--param",
        "--params-file",
        "--log-level",
        "-e",
        "--enclave",
        "--log-config-file",
        "a:=b",
        "__node:=n",
        "__ns:=/n",
        "x:y:=z",
        "merge:=true",
        "a.b:={c: [1, 2]}",
        "p:=[",
        ":=",
        ":",
        "~/a:=~/b",
    ]);
    prop_oneof![known.prop_map(str::to_owned), "[-_~/:=a-z*0-9{}\\[\\] ]{0,12}", any::<String>()]
}

proptest! {
    #[test]
    fn no_command_line_panics_and_words_outside_of_groups_are_kept(
        words in prop::collection::vec(word(), 0..20),
    ) {
        let outside: Vec<OsString> =
            words.iter().take_while(|word| *word != BEGIN).map(OsString::from).collect();
        match split(words.iter().map(OsString::from)) {
            Ok((rest, taken)) => {
                prop_assert!(rest.starts_with(&outside));
                prop_assert_eq!(taken.is_some(), outside.len() < words.len());
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    #[test]
    fn with_a_group_at_the_end_every_other_word_reaches_the_program(
        before in prop::collection::vec("[a-z-]{1,8}", 0..6),
        after in prop::collection::vec("[a-z-]{1,8}", 0..6),
    ) {
        let group = ["--ros-args", "-r", "a:=b", "--"].map(String::from);
        let all = [before.clone(), group.to_vec(), after.clone()].concat();
        let (rest, _) = split(all.into_iter().map(OsString::from)).unwrap();
        let expected: Vec<OsString> = before.into_iter().chain(after).map(OsString::from).collect();
        prop_assert_eq!(rest, expected);
    }
}
