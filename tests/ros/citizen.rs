//! The program as `ros2 launch` starts it, seen by a CycloneDDS peer that knows only the names that
//! the launcher gave.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, ExitStatus};
use std::time::Duration;

use graintwin::command::Disposition;
use graintwin::msg::rcl;
use ros2_client::{Client, Message, Name, Node, QosProfile, ServiceMapping, ServiceTypeName};
use serde_json::{Value, json};
use tokio::runtime::Builder;
use tokio::time::timeout;

use crate::joined::join;
use crate::network::{Loopback, alone};
use crate::python;

/// A grain between six walls that it touches: the smallest specimen with forces.
const SCENE: &str = "
name: one grain
pack: {file: grain.csv, box: {min: [-1.0e-3, -1.0e-3, -1.0e-3], max: [1.0e-3, 1.0e-3, 1.0e-3]}}
node: {service_mapping: cyclone}
";

/// The program, killed when a test gives up.
struct Program(Child);

impl Program {
    fn terminate(mut self) -> ExitStatus {
        let pid = self.0.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &pid]).status().unwrap().success());
        self.0.wait().unwrap()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // An error says that it has ended.
        self.0.kill().ok();
    }
}

fn specimen(folder: &Path) {
    fs::write(folder.join("scene.yaml"), SCENE).unwrap();
    fs::write(
        folder.join("grain.csv"),
        "x,y,z,radius,young,poisson,density,friction\n0,0,0,1.00001e-3,70e9,0.2,2500,0\n",
    )
    .unwrap();
}

fn doubles(answer: &Value) -> Vec<f64> {
    let values = answer["values"].as_array().unwrap();
    values.iter().map(|value| value["double_value"].as_f64().unwrap()).collect()
}

#[test]
fn a_renamed_node_obeys_its_topics_and_its_parameters_answer_a_cyclone_peer() {
    let Some(python) = python::python() else { return };
    alone(
        a_renamed_node_obeys_its_topics_and_its_parameters_answer_a_cyclone_peer,
        Loopback::Multicast,
        || {
            let folder = tempfile::tempdir().unwrap();
            let folder = folder.path();
            specimen(folder);
            fs::write(
                folder.join("params.yaml"),
                "/**:\n  ros__parameters:\n    stale_after: 7.5\n    for_another_node: 1\n\
                 /lab/twin:\n  ros__parameters: {merge: false}\n",
            )
            .unwrap();
            // First, since what the log says is of interest for ten seconds.
            let mut peer = Command::new(&python)
                .arg("-B")
                .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peer/citizen.py"))
                .arg(folder.join("told.json"))
                .args(["/lab/twin", "/rig/command", "/lab/answers"])
                .spawn()
                .unwrap();
            let program = Command::new(env!("CARGO_BIN_EXE_graintwin"))
                .current_dir(folder)
                .env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
                .args(["run", "scene.yaml", "--threads", "1", "--ros-args"])
                .args(["-r", "__node:=twin", "-r", "__ns:=/lab"])
                .args(["-r", "~/boundary_command:=/rig/command", "-r", "twin:~/report:=answers"])
                .args(["--params-file", "params.yaml", "-p", "merge:=false", "--"])
                .spawn()
                .map(Program)
                .unwrap();
            assert!(peer.wait().unwrap().success());
            let ended = program.terminate();
            assert_eq!(ended.code(), Some(3), "a command was refused");

            let told: Value =
                serde_json::from_str(&fs::read_to_string(folder.join("told.json")).unwrap())
                    .unwrap();
            println!("{told:#}");
            let reports = told["reports"].as_array().unwrap();
            let (old, new) = (&reports[0], &reports[1]);
            assert_eq!(old["disposition"], json!(Disposition::Stale as u8));
            assert!(old["text"].as_str().unwrap().contains("at most 7.5 s are allowed"));
            assert_eq!(new["disposition"], json!(Disposition::Applied as u8), "{new}");
            parameters_are_told(&told);
            sets_are_refused_or_taken(&told);
            let record = &told["rosout"][0];
            assert_eq!((&record["level"], &record["name"]), (&json!(30), &json!("lab.twin")));
            let said = record["msg"].as_str().unwrap();
            assert!(said.starts_with("params.yaml:4: there is no parameter `for_another_node`"));
        },
    );
}

fn parameters_are_told(told: &Value) {
    let names = told["list"]["result"]["names"].as_array().unwrap();
    assert!(names.contains(&json!("stale_after")) && names.contains(&json!("use_sim_time")));
    assert_eq!(told["list"]["result"]["prefixes"], json!(["limits", "solver", "view"]));
    let below = ["clamp", "force", "rate", "strain", "travel"].map(|name| format!("limits.{name}"));
    assert_eq!(told["list_below"]["result"]["names"], json!(below));
    assert_eq!(told["types"]["types"], json!([4, 3, 1, 0]));
    let got = &told["get"]["values"];
    assert_eq!(got[0]["string_value"], "one grain");
    assert_eq!(got[1]["double_value"], 7.5);
    assert_eq!(got[2]["bool_value"], false);
    assert_eq!(got[3]["type"], 0);
    let described = &told["describe"]["descriptors"];
    assert_eq!(described[0]["type"], 3);
    assert_eq!(described[0]["read_only"], false);
    let range = json!([{"from_value": 1e-13, "to_value": 1e-2, "step": 0.0}]);
    assert_eq!(described[0]["floating_point_range"], range);
    assert_eq!(described[1]["read_only"], true);
    assert_eq!(described[1]["description"], "Name of the scene");
    assert_eq!(described[2]["name"], "no_such");
    assert_eq!(described[2]["type"], 0);
}

fn sets_are_refused_or_taken(told: &Value) {
    let results = told["set"]["results"].as_array().unwrap();
    let successes: Vec<&Value> = results.iter().map(|result| &result["successful"]).collect();
    assert_eq!(successes, [true, false, false, false]);
    let reason = |index: usize| results[index]["reason"].as_str().unwrap();
    assert!(reason(1).starts_with("stale_after cannot be -1.0"), "{}", reason(1));
    assert!(reason(2).starts_with("scene is read-only"), "{}", reason(2));
    assert!(reason(3).starts_with("limits.travel is of type double, not integer"), "{}", reason(3));

    assert_eq!(told["set_bad"]["result"]["successful"], false);
    assert_eq!(doubles(&told["get_after_bad"])[..2], [0.0, 0.0]);
    assert_eq!(told["get_after_bad"]["values"][2]["bool_value"], true);
    assert_eq!(told["set_good"]["result"]["successful"], true);
    assert_eq!(doubles(&told["get_after_good"]), [5.0, 0.001]);

    let events = told["events"].as_array().unwrap();
    let changed: Vec<Vec<&Value>> = events
        .iter()
        .map(|event| {
            assert_eq!(event["node"], "/lab/twin");
            event["changed_parameters"].as_array().unwrap().iter().map(|one| &one["name"]).collect()
        })
        .collect();
    assert_eq!(changed, [vec!["merge"], vec!["limits.force", "limits.travel"]]);
}

#[test]
fn arguments_that_no_node_takes_end_the_program_before_it_joins_anything() {
    let folder = tempfile::tempdir().unwrap();
    specimen(folder.path());
    fs::write(folder.path().join("bad.yaml"), "/**:\n  ros__parameters:\n    merge: 1\n").unwrap();
    for (arguments, told) in [
        (&["-r", "__node:=1twin"][..], "`1twin` is no name of a node"),
        (&["-p", "stale_after:=1"], "-p stale_after: stale_after is of type double, not integer"),
        (&["-p", "seed:=4"], "seed is read-only"),
        (&["--params-file", "bad.yaml"], "bad.yaml:3: merge is of type bool, not integer"),
        (&["--params-file", "none.yaml"], "none.yaml: "),
        (&["--log-level"], "LEVEL or LOGGER:=LEVEL must follow it"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .current_dir(folder.path())
            .args(["run", "scene.yaml", "--ros-args"])
            .args(arguments)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(told), "{arguments:?}: {said}");
    }
}

#[test]
fn the_virtual_rig_finds_a_node_whatever_it_is_called() {
    alone(the_virtual_rig_finds_a_node_whatever_it_is_called, Loopback::Plain, || {
        let folder = tempfile::tempdir().unwrap();
        specimen(folder.path());
        let scene = "
pack: {file: grain.csv, box: {min: [-1.0e-3, -1.0e-3, -1.0e-3], max: [1.0e-3, 1.0e-3, 1.0e-3]}}
node: {virtual_rig: true}
load_path: {isotropic: {strain: 1.0e-5, increments: 20}}
";
        fs::write(folder.path().join("played.yaml"), scene).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .current_dir(folder.path())
            .args(["run", "played.yaml", "--json", "--ros-args", "-r", "__ns:=/lab/a"])
            .args(["-r", "__node:=twin", "-r", "~/boundary_command:=/rig/command"])
            .args(["-r", "/lab/a/twin/report:=answers"])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(summary["commands"], json!({"APPLIED": 20}), "{said}");
        assert_eq!(summary["virtual_rig"]["answered"], json!(20));
    });
}

#[test]
fn without_a_word_about_the_middleware_parameters_answer_in_the_common_mapping() {
    alone(
        without_a_word_about_the_middleware_parameters_answer_in_the_common_mapping,
        Loopback::Plain,
        || {
            let folder = tempfile::tempdir().unwrap();
            specimen(folder.path());
            let scene = SCENE.replace("service_mapping: cyclone", "");
            fs::write(folder.path().join("scene.yaml"), scene).unwrap();
            let program = Command::new(env!("CARGO_BIN_EXE_graintwin"))
                .current_dir(folder.path())
                .env_remove("RMW_IMPLEMENTATION")
                .args(["run", "scene.yaml", "--ros"])
                .spawn()
                .map(Program)
                .unwrap();
            let (described, set) = ask_in_the_common_mapping();
            assert_eq!(described.descriptors[0].kind, 1);
            assert!(described.descriptors[0].description.contains("/clock"));
            assert!(!set.result.successful);
            assert!(set.result.reason.starts_with("version is read-only"), "{}", set.result.reason);
            let ended = program.terminate();
            assert!(ended.success(), "{ended}");
        },
    );
}

/// Describes one parameter and sets another, as a client of `rmw_fastrtps_cpp`'s mapping.
fn ask_in_the_common_mapping() -> (rcl::Descriptors, rcl::OneResult) {
    let mut node = join("asker");
    let describe = client::<rcl::Names, rcl::Descriptors>(
        &mut node,
        "describe_parameters",
        "DescribeParameters",
    );
    let set = client::<rcl::SetParameters, rcl::OneResult>(
        &mut node,
        "set_parameters_atomically",
        "SetParametersAtomically",
    );
    let runtime = Builder::new_multi_thread().worker_threads(1).enable_time().build().unwrap();
    runtime.spawn(node.spinner().unwrap().spin());
    runtime.block_on(async {
        let answers = async {
            describe.wait_for_service(&node).await;
            let names = vec!["use_sim_time".to_owned()];
            let described = describe.async_call_service(rcl::Names { names }).await.unwrap();
            set.wait_for_service(&node).await;
            let value = rcl::ParameterValue {
                kind: 4,
                string_value: "2".into(),
                ..rcl::ParameterValue::default()
            };
            let parameters = vec![rcl::Parameter { name: "version".into(), value }];
            let set = set.async_call_service(rcl::SetParameters { parameters }).await.unwrap();
            (described, set)
        };
        timeout(Duration::from_secs(60), answers).await.expect("an answer within a minute")
    })
}

fn client<Q, A>(node: &mut Node, name: &str, kind: &str) -> Client<Q, A>
where
    Q: Message + Clone + 'static,
    A: Message + 'static,
{
    let qos = QosProfile::publisher_default();
    let name = Name::new("/graintwin", name).unwrap();
    let kind = ServiceTypeName::new("rcl_interfaces", kind);
    node.create_client(ServiceMapping::Enhanced, &name, &kind, qos.clone(), qos).unwrap()
}
