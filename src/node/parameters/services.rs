//! The six services that every ROS 2 node has for its parameters, and `/parameter_events`.

use std::pin::pin;
use std::sync::Arc;

use futures::StreamExt;
use ros2_client::qos::History;
use ros2_client::service::Server;
use ros2_client::{Message, MessageTypeName, Name, Node, Publisher, QosProfile, ServiceTypeName};
use serde::Serialize;
use tokio::runtime::Runtime;
use tokio::task::JoinHandle;

use super::{Descriptor, Field, Kind, Parameters, Refusal, Value, find, list};
use crate::msg::{rcl, topics};
use crate::node::clock::Clock;
use crate::node::discrepancy::{Recorder, record};
use crate::node::names::Identity;
use crate::node::{NodeError, mapping};
use crate::scene;
use crate::sink::Beside;

/// Requests that may wait, and answers that are kept for a client that lost one.
const DEPTH: usize = 64;

/// The services, before anything answers.
pub(in crate::node) struct Services {
    get: Server<rcl::Names, rcl::Values>,
    types: Server<rcl::Names, rcl::Types>,
    describe: Server<rcl::Names, rcl::Descriptors>,
    set: Server<rcl::SetParameters, rcl::Results>,
    set_atomically: Server<rcl::SetParameters, rcl::OneResult>,
    list: Server<rcl::ListParameters, rcl::Listed>,
    events: Events,
}

/// Tells of changes.
struct Events {
    publisher: Publisher<rcl::ParameterEvent>,
    node: String,
    clock: Clock,
    recorder: Recorder,
}

impl Services {
    /// Makes the services and the publisher of `node`.
    pub(in crate::node) fn new(
        node: &mut Node,
        identity: &Identity,
        options: &scene::Node,
        clock: &Clock,
    ) -> Result<Self, NodeError> {
        let mut maker = Maker { node, identity, mapping: mapping::service_mapping(options) };
        Ok(Self {
            get: maker.server("get_parameters", "GetParameters")?,
            types: maker.server("get_parameter_types", "GetParameterTypes")?,
            describe: maker.server("describe_parameters", "DescribeParameters")?,
            set: maker.server("set_parameters", "SetParameters")?,
            set_atomically: maker.server("set_parameters_atomically", "SetParametersAtomically")?,
            list: maker.server("list_parameters", "ListParameters")?,
            events: Events::new(node, identity, clock)?,
        })
    }

    /// Answers from `parameters` until the tasks are aborted.
    pub(in crate::node) fn serve(
        self,
        runtime: &Runtime,
        parameters: &Parameters,
        recorder: &Recorder,
    ) -> Vec<JoinHandle<()>> {
        let Self { get, types, describe, set, set_atomically, list, events } = self;
        let events = Arc::new(Events { recorder: Arc::clone(recorder), ..events });
        let store = || parameters.clone();
        let (getter, setter, atomic) = (store(), store(), store());
        let told = Arc::clone(&events);
        vec![
            runtime.spawn(answer(get, move |request: rcl::Names| {
                let value = |name: &String| getter.get(name).map(to_wire).unwrap_or_default();
                Reply::plain(rcl::Values { values: request.names.iter().map(value).collect() })
            })),
            runtime.spawn(answer(types, |request: rcl::Names| {
                let kind = |name: &String| find(name).map_or(Kind::NOT_SET.0, |one| one.kind().0);
                Reply::plain(rcl::Types { types: request.names.iter().map(kind).collect() })
            })),
            runtime.spawn(answer(describe, |request: rcl::Names| {
                let descriptors = request.names.into_iter().map(described).collect();
                Reply::plain(rcl::Descriptors { descriptors })
            })),
            runtime.spawn(answer_and_tell(set, events, move |request: rcl::SetParameters| {
                let (mut results, mut done) = (Vec::new(), Vec::new());
                for parameter in request.parameters {
                    let set = setter.set(&[from_wire(&parameter)]);
                    results.push(result(&set));
                    done.extend(set.is_ok().then_some(parameter));
                }
                Reply { response: rcl::Results { results }, changed: done }
            })),
            runtime.spawn(answer_and_tell(
                set_atomically,
                told,
                move |request: rcl::SetParameters| {
                    let wanted: Vec<_> = request.parameters.iter().map(from_wire).collect();
                    let set = atomic.set(&wanted);
                    let changed = if set.is_ok() { request.parameters } else { Vec::new() };
                    Reply { response: rcl::OneResult { result: result(&set) }, changed }
                },
            )),
            runtime.spawn(answer(list, |request: rcl::ListParameters| {
                let (names, prefixes) = self::list(&request.prefixes, request.depth);
                let owned = |names: Vec<&str>| names.into_iter().map(Into::into).collect();
                let result =
                    rcl::ListParametersResult { names: owned(names), prefixes: owned(prefixes) };
                Reply::plain(rcl::Listed { result })
            })),
        ]
    }
}

struct Maker<'a> {
    node: &'a mut Node,
    identity: &'a Identity,
    mapping: ros2_client::service::ServiceMapping,
}

impl Maker<'_> {
    fn server<Q, A>(&mut self, name: &str, kind: &str) -> Result<Server<Q, A>, NodeError>
    where
        Q: Message + Clone + 'static,
        A: Message + 'static,
    {
        let name = self.identity.resolve(&format!("~/{name}"));
        let failed = |error: &dyn std::error::Error| NodeError::Endpoint {
            topic: name.clone(),
            reason: error.to_string(),
        };
        let parsed = Name::parse(&name).map_err(|error| failed(&error))?;
        let kind = ServiceTypeName::new("rcl_interfaces", kind);
        let qos = QosProfile::publisher_default().history(History::KeepLast { depth: DEPTH });
        self.node
            .create_server(self.mapping, &parsed, &kind, qos.clone(), qos)
            .map_err(|error| failed(&error))
    }
}

impl Events {
    fn new(node: &mut Node, identity: &Identity, clock: &Clock) -> Result<Self, NodeError> {
        let name = identity.resolve(topics::PARAMETER_EVENTS.name);
        let failed = |error: &dyn std::error::Error| NodeError::Endpoint {
            topic: name.clone(),
            reason: error.to_string(),
        };
        let depth = topics::PARAMETER_EVENTS.qos.depth as usize;
        let qos = QosProfile::publisher_default().history(History::KeepLast { depth });
        let parsed = Name::parse(&name).map_err(|error| failed(&error))?;
        let kind = MessageTypeName::new("rcl_interfaces", "ParameterEvent");
        let topic = node.create_topic(&parsed, kind, &qos).map_err(|error| failed(&error))?;
        let publisher = node.create_publisher(&topic, Some(qos)).map_err(|error| failed(&error))?;
        let (node, clock) = (identity.full_name(), clock.clone());
        Ok(Self { publisher, node, clock, recorder: Recorder::default() })
    }

    async fn tell(&self, changed_parameters: Vec<rcl::Parameter>) {
        if changed_parameters.is_empty() {
            return;
        }
        let event = rcl::ParameterEvent {
            stamp: self.clock.now().into(),
            node: self.node.clone(),
            changed_parameters,
            ..rcl::ParameterEvent::default()
        };
        record(&self.recorder, || Beside::ParameterEvent(event.clone()));
        if self.publisher.async_publish(event).await.is_err() {
            tracing::warn!(
                "a subscriber of {} does not take what it is sent",
                topics::PARAMETER_EVENTS.name
            );
        }
    }
}

/// What goes back to a client, and what everybody is told.
struct Reply<A> {
    response: A,
    changed: Vec<rcl::Parameter>,
}

impl<A> Reply<A> {
    fn plain(response: A) -> Self {
        Self { response, changed: Vec::new() }
    }
}

async fn answer<Q, A>(server: Server<Q, A>, reply: impl FnMut(Q) -> Reply<A>)
where
    Q: Message + Clone + 'static,
    A: Message + Serialize + 'static,
{
    respond(server, None, reply).await;
}

async fn answer_and_tell<Q, A>(
    server: Server<Q, A>,
    events: Arc<Events>,
    reply: impl FnMut(Q) -> Reply<A>,
) where
    Q: Message + Clone + 'static,
    A: Message + Serialize + 'static,
{
    respond(server, Some(events), reply).await;
}

async fn respond<Q, A>(
    server: Server<Q, A>,
    events: Option<Arc<Events>>,
    mut reply: impl FnMut(Q) -> Reply<A>,
) where
    Q: Message + Clone + 'static,
    A: Message + Serialize + 'static,
{
    let mut requests = pin!(server.receive_request_stream());
    while let Some(request) = requests.next().await {
        let (id, request) = match request {
            Ok(received) => received,
            Err(error) => {
                tracing::warn!(
                    "a request about parameters cannot be read, perhaps its sender uses another \
                     middleware (RMW_IMPLEMENTATION, node.service_mapping): {error}"
                );
                continue;
            }
        };
        let Reply { response, changed } = reply(request);
        if let Err(error) = server.async_send_response(id, response).await {
            tracing::warn!("an answer about parameters is lost: {error}");
        }
        if let Some(events) = &events {
            events.tell(changed).await;
        }
    }
}

fn result(set: &Result<(), Refusal>) -> rcl::SetParametersResult {
    match set {
        Ok(()) => rcl::SetParametersResult { successful: true, reason: String::new() },
        Err(refusal) => rcl::SetParametersResult { successful: false, reason: refusal.to_string() },
    }
}

fn from_wire(parameter: &rcl::Parameter) -> (String, Value) {
    let value = &parameter.value;
    let value = match Kind(value.kind) {
        Kind::BOOL => Value::Bool(value.bool_value),
        Kind::INTEGER => Value::Integer(value.integer_value),
        Kind::DOUBLE => Value::Double(value.double_value),
        Kind::STRING => Value::Text(value.string_value.clone()),
        other => Value::Other(other),
    };
    (parameter.name.clone(), value)
}

fn to_wire(value: Value) -> rcl::ParameterValue {
    let mut wire = rcl::ParameterValue { kind: value.kind().0, ..rcl::ParameterValue::default() };
    match value {
        Value::Bool(value) => wire.bool_value = value,
        Value::Integer(value) => wire.integer_value = value,
        Value::Double(value) => wire.double_value = value,
        Value::Text(value) => wire.string_value = value,
        Value::Other(_) => {}
    }
    wire
}

/// The descriptor of a parameter; of one that does not exist, its name only.
fn described(name: String) -> rcl::ParameterDescriptor {
    let Ok(descriptor) = find(&name) else {
        return rcl::ParameterDescriptor { name, ..rcl::ParameterDescriptor::default() };
    };
    let Descriptor { description, field, .. } = descriptor;
    let (constraints, range) = match field {
        Field::Double(_, range) | Field::DoubleAtStart(_, range) => {
            let bounds =
                rcl::FloatingPointRange { from_value: range.from, to_value: range.to, step: 0.0 };
            (range.to_string(), vec![bounds])
        }
        Field::Text(_) | Field::Count(_) | Field::Bool(_) | Field::AtStart(_) => {
            (String::new(), Vec::new())
        }
    };
    rcl::ParameterDescriptor {
        name,
        kind: descriptor.kind().0,
        description: (*description).into(),
        additional_constraints: constraints,
        read_only: descriptor.read_only(),
        dynamic_typing: false,
        floating_point_range: range,
        integer_range: Vec::new(),
    }
}
