"""A rig that knows a node by the names its launcher gave it: commands it, and asks for and sets its
parameters as rmw_cyclonedds_cpp would.

    citizen.py OUT.json NODE COMMAND_TOPIC REPORT_TOPIC

Names are full ROS names. OUT.json holds what came back of each step. The domain is that of
ROS_DOMAIN_ID. Exit code 1 when something is not found or stays without an answer.
"""

import json
import os
import struct
import sys
import time
import types
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int64, sequence, uint8, uint32, uint64
from cyclonedds.internal import InvalidSample
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from messages import BoundaryCommand, Header, Report, Time, qos
from play import plain

SECONDS = 60


def rcl(name, kind="msg"):
    return f"rcl_interfaces.{kind}.dds_.{name}_"


@dataclass
class ParameterValue(IdlStruct, typename=rcl("ParameterValue")):
    type: uint8
    bool_value: bool
    integer_value: int64
    double_value: float64
    string_value: str
    byte_array_value: sequence[uint8]
    bool_array_value: sequence[bool]
    integer_array_value: sequence[int64]
    double_array_value: sequence[float64]
    string_array_value: sequence[str]


@dataclass
class Parameter(IdlStruct, typename=rcl("Parameter")):
    name: str
    value: ParameterValue


@dataclass
class FloatingPointRange(IdlStruct, typename=rcl("FloatingPointRange")):
    from_value: float64
    to_value: float64
    step: float64


@dataclass
class IntegerRange(IdlStruct, typename=rcl("IntegerRange")):
    from_value: int64
    to_value: int64
    step: uint64


@dataclass
class ParameterDescriptor(IdlStruct, typename=rcl("ParameterDescriptor")):
    name: str
    type: uint8
    description: str
    additional_constraints: str
    read_only: bool
    dynamic_typing: bool
    floating_point_range: sequence[FloatingPointRange, 1]
    integer_range: sequence[IntegerRange, 1]


@dataclass
class SetParametersResult(IdlStruct, typename=rcl("SetParametersResult")):
    successful: bool
    reason: str


@dataclass
class ListParametersResult(IdlStruct, typename=rcl("ListParametersResult")):
    names: sequence[str]
    prefixes: sequence[str]


@dataclass
class ParameterEvent(IdlStruct, typename=rcl("ParameterEvent")):
    stamp: Time
    node: str
    new_parameters: sequence[Parameter]
    changed_parameters: sequence[Parameter]
    deleted_parameters: sequence[Parameter]


@dataclass
class Log(IdlStruct, typename=rcl("Log")):
    stamp: Time
    level: uint8
    name: str
    msg: str
    file: str
    function: str
    line: uint32


def service(name, request, response):
    """Request and response of a service with the header of rmw_cyclonedds_cpp in front."""

    def struct_(suffix, fields):
        annotations = {"guid": uint64, "seq": int64, **fields}
        return dataclass(
            types.new_class(
                name + suffix,
                (IdlStruct,),
                {"typename": rcl(name + suffix, "srv")},
                lambda body: body.update(__annotations__=annotations, __module__=__name__),
            )
        )

    return struct_("_Request", request), struct_("_Response", response)


SERVICES = {
    "get_parameters": service(
        "GetParameters", {"names": sequence[str]}, {"values": sequence[ParameterValue]}
    ),
    "get_parameter_types": service(
        "GetParameterTypes", {"names": sequence[str]}, {"types": sequence[uint8]}
    ),
    "describe_parameters": service(
        "DescribeParameters",
        {"names": sequence[str]},
        {"descriptors": sequence[ParameterDescriptor]},
    ),
    "set_parameters": service(
        "SetParameters", {"parameters": sequence[Parameter]}, {"results": sequence[SetParametersResult]}
    ),
    "set_parameters_atomically": service(
        "SetParametersAtomically",
        {"parameters": sequence[Parameter]},
        {"result": SetParametersResult},
    ),
    "list_parameters": service(
        "ListParameters",
        {"prefixes": sequence[str], "depth": uint64},
        {"result": ListParametersResult},
    ),
}

LATCHED = Qos(
    Policy.Reliability.Reliable(duration(seconds=10)),
    Policy.Durability.TransientLocal,
    Policy.History.KeepLast(1000),
)


def wait_for(what, ready):
    end = time.monotonic() + SECONDS
    while not ready():
        if time.monotonic() > end:
            sys.exit(f"waited in vain for {what}")
        time.sleep(0.01)


class Reader:
    """Everything that a topic brings."""

    def __init__(self, participant, name, kind, quality):
        self.name = name
        self.reader = DataReader(participant, Topic(participant, name, kind), qos=quality)
        self.got = []

    def matched(self):
        return len(self.reader.get_matched_publications()) > 0

    def take(self):
        samples = self.reader.take(N=100)
        self.got += [sample for sample in samples if not isinstance(sample, InvalidSample)]
        return self.got


class Client:
    """A client of one service."""

    def __init__(self, participant, node, name):
        self.request, response = SERVICES[name]
        self.writer = DataWriter(
            participant,
            Topic(participant, f"rq{node}/{name}Request", self.request),
            qos=qos(10),
        )
        self.replies = Reader(participant, f"rr{node}/{name}Reply", response, qos(10))
        self.name = name
        # The second half of the guid of the writer, as its bytes stand in memory.
        self.guid = struct.unpack("=Q", self.writer.guid.bytes[8:])[0]
        self.sequence = 0

    def matched(self):
        return self.replies.matched() and len(self.writer.get_matched_subscriptions()) > 0

    def call(self, **fields):
        self.sequence += 1
        self.writer.write(self.request(guid=self.guid, seq=self.sequence, **fields))

        def mine():
            return [
                reply
                for reply in self.replies.take()
                if reply.guid == self.guid and reply.seq == self.sequence
            ]

        wait_for(f"the answer of {self.name}", mine)
        answer = plain(mine()[0])
        del answer["guid"], answer["seq"]
        return answer


def value(of):
    """A parameter's value of the type that Python has for it."""
    kind = {bool: 1, int: 2, float: 3, str: 4}[type(of)]
    return ParameterValue(
        type=kind,
        bool_value=of if kind == 1 else False,
        integer_value=of if kind == 2 else 0,
        double_value=of if kind == 3 else 0.0,
        string_value=of if kind == 4 else "",
        byte_array_value=[],
        bool_array_value=[],
        integer_array_value=[],
        double_array_value=[],
        string_array_value=[],
    )


def parameters(**of):
    return [Parameter(name.replace("__", "."), value(one)) for name, one in of.items()]


def main():
    out, node, command_topic, report_topic = sys.argv[1:]
    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    reports = Reader(participant, f"rt{report_topic}", Report, qos(100))
    events = Reader(participant, "rt/parameter_events", ParameterEvent, qos(100))
    rosout = Reader(participant, "rt/rosout", Log, LATCHED)
    commands = DataWriter(
        participant, Topic(participant, f"rt{command_topic}", BoundaryCommand), qos=qos(10)
    )
    clients = {name: Client(participant, node, name) for name in SERVICES}
    for one in (reports, events, rosout):
        wait_for(f"a publisher of {one.name}", one.matched)
    wait_for(
        f"a subscriber of {command_topic}", lambda: len(commands.get_matched_subscriptions()) > 0
    )
    for client in clients.values():
        wait_for(f"a server of {client.name}", client.matched)
    time.sleep(0.8)

    told = {}
    # Of 1970, and of now.
    for sequence, stamp in enumerate((Time(1, 0), Time(int(time.time()), 0)), start=1):
        displacement = [0.0, 0.0, 0.0, 0.0, 1e-8, 0.0]
        header = Header(stamp, "pack")
        commands.write(BoundaryCommand(header, "citizen", sequence, 0, displacement))

    def answers():
        return [one for one in reports.take() if one.session == "citizen"]

    wait_for("the reports", lambda: len(answers()) == 2)
    told["reports"] = [plain(one) for one in answers()]

    call = {name: client.call for name, client in clients.items()}
    names = ["scene", "stale_after", "merge", "no_such"]
    told["list"] = call["list_parameters"](prefixes=[], depth=0)
    told["list_below"] = call["list_parameters"](prefixes=["limits"], depth=0)
    told["get"] = call["get_parameters"](names=names)
    told["types"] = call["get_parameter_types"](names=names)
    told["describe"] = call["describe_parameters"](names=["solver.tolerance", "scene", "no_such"])
    told["set"] = call["set_parameters"](
        parameters=parameters(merge=True, stale_after=-1.0, scene="other", limits__travel=1)
    )
    told["set_bad"] = call["set_parameters_atomically"](
        parameters=parameters(limits__force=5.0, limits__travel=-1.0)
    )
    told["get_after_bad"] = call["get_parameters"](names=["limits.force", "limits.travel", "merge"])
    told["set_good"] = call["set_parameters_atomically"](
        parameters=parameters(limits__force=5.0, limits__travel=0.001)
    )
    told["get_after_good"] = call["get_parameters"](names=["limits.force", "limits.travel"])
    wait_for("two parameter events", lambda: len(events.take()) >= 2)
    wait_for("the log", rosout.take)
    told["events"] = [plain(event) for event in events.got]
    told["rosout"] = [plain(record) for record in rosout.got]
    with open(out, "w", encoding="utf-8") as file:
        json.dump(told, file)


if __name__ == "__main__":
    main()
