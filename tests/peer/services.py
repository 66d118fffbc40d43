"""The services of graintwin for CycloneDDS, in the mapping of rmw_cyclonedds_cpp: a header with the
caller's identity and the number of the call stands before every request and response.

Written from the .srv texts by hand, independently of the Rust types.
"""

from dataclasses import dataclass
from typing import NamedTuple

from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import int64, uint8, uint64


@dataclass
class TriggerRequest(IdlStruct, typename="std_srvs.srv.dds_.Trigger_Request_"):
    guid: uint64
    seq: int64
    structure_needs_at_least_one_member: uint8 = 0


@dataclass
class TriggerResponse(IdlStruct, typename="std_srvs.srv.dds_.Trigger_Response_"):
    guid: uint64
    seq: int64
    success: bool
    message: str


@dataclass
class SetBoolRequest(IdlStruct, typename="std_srvs.srv.dds_.SetBool_Request_"):
    guid: uint64
    seq: int64
    data: bool


@dataclass
class SetBoolResponse(IdlStruct, typename="std_srvs.srv.dds_.SetBool_Response_"):
    guid: uint64
    seq: int64
    success: bool
    message: str


@dataclass
class SavePackRequest(IdlStruct, typename="graintwin_msgs.srv.dds_.SavePack_Request_"):
    guid: uint64
    seq: int64
    path: str


@dataclass
class SavePackResponse(IdlStruct, typename="graintwin_msgs.srv.dds_.SavePack_Response_"):
    guid: uint64
    seq: int64
    success: bool
    message: str


class Service(NamedTuple):
    request: type
    response: type


SERVICES = {
    "reset": Service(TriggerRequest, TriggerResponse),
    "reset_faults": Service(TriggerRequest, TriggerResponse),
    "hold": Service(SetBoolRequest, SetBoolResponse),
    "save_pack": Service(SavePackRequest, SavePackResponse),
}
