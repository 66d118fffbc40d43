"""The messages and topics of graintwin for CycloneDDS, written from msgs/ by hand.

Independent of the Rust types on purpose: a wrong field, order or type on either side shows.
"""

from dataclasses import dataclass
from typing import NamedTuple

from cyclonedds.core import Policy, Qos
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float32, float64, int32, sequence, uint8, uint32, uint64
from cyclonedds.util import duration


@dataclass
class Time(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs.msg.dds_.Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Wrench(IdlStruct, typename="geometry_msgs.msg.dds_.Wrench_"):
    force: Vector3
    torque: Vector3


@dataclass
class WrenchStamped(IdlStruct, typename="geometry_msgs.msg.dds_.WrenchStamped_"):
    header: Header
    wrench: Wrench


@dataclass
class JointState(IdlStruct, typename="sensor_msgs.msg.dds_.JointState_"):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclass
class BoundaryCommand(IdlStruct, typename="graintwin_msgs.msg.dds_.BoundaryCommand_"):
    header: Header
    session: str
    sequence: uint64
    mode: uint8
    displacement: array[float64, 6]


@dataclass
class WallForces(IdlStruct, typename="graintwin_msgs.msg.dds_.WallForces_"):
    header: Header
    increment: uint64
    normal_force: array[float64, 6]
    displacement: array[float64, 6]
    force: array[Vector3, 6]
    moment: array[Vector3, 6]


@dataclass
class PackState(IdlStruct, typename="graintwin_msgs.msg.dds_.PackState_"):
    header: Header
    increment: uint64
    strain: array[float64, 3]
    stress_walls: array[float64, 9]
    stress_contacts: array[float64, 9]
    confining_stress: float64
    deviatoric_stress: float64
    porosity: float64
    coordination_number: float64
    sliding_ratio: float64
    stored_energy: float64
    dissipated_energy: float64
    contacts: uint32
    rattlers: uint32
    iterations: uint32
    residual: float64
    solve_seconds: float64
    converged: bool


@dataclass
class Moduli(IdlStruct, typename="graintwin_msgs.msg.dds_.Moduli_"):
    header: Header
    increment: uint64
    valid: bool
    bulk: float64
    shear: float64
    young: float64
    poisson: float64
    lame: float64
    p_wave: float64
    tangent: array[float64, 9]


@dataclass
class TangentModuli(IdlStruct, typename="graintwin_msgs.msg.dds_.TangentModuli_"):
    valid: bool
    error: float64
    relaxed: array[float64, 9]
    affine: array[float64, 9]
    wall_stiffness: sequence[float64]
    bulk: float64
    shear: float64
    young: float64
    poisson: float64
    lame: float64
    p_wave: float64
    shear_pairs: array[float64, 3]
    p_speed: array[float64, 3]
    s_speed: array[float64, 3]
    isotropy_index: float64


@dataclass
class Tangent(IdlStruct, typename="graintwin_msgs.msg.dds_.Tangent_"):
    header: Header
    increment: uint64
    density: float64
    products: uint64
    stands: TangentModuli
    sticks: TangentModuli


@dataclass
class ContactNetwork(IdlStruct, typename="graintwin_msgs.msg.dds_.ContactNetwork_"):
    header: Header
    increment: uint64
    chunk: uint32
    chunk_count: uint32
    first: sequence[uint32]
    second: sequence[uint32]
    normal: sequence[float64]
    normal_force: sequence[float64]
    tangential_force: sequence[float64]
    overlap: sequence[float64]
    state: sequence[uint8]


@dataclass
class GrainMotion(IdlStruct, typename="graintwin_msgs.msg.dds_.GrainMotion_"):
    header: Header
    increment: uint64
    chunk: uint32
    chunk_count: uint32
    first_grain: uint32
    displacement: sequence[float64]
    non_affine: sequence[float64]
    rotation: sequence[float64]
    total_rotation: sequence[float64]
    d2min: sequence[float64]
    shear_strain: sequence[float64]
    volumetric_strain: sequence[float64]
    carries: sequence[bool]
    affine_rms: float64
    non_affine_rms: float64
    non_affine_ratio: float64
    rotation_rms: float64
    participation: float64
    rotation_participation: float64
    d2min_top_1: float64
    d2min_top_10: float64
    band_center: array[float64, 3]
    band_normal: array[float64, 3]
    band_spread: array[float64, 3]
    band_thickness: float64


@dataclass
class Event(IdlStruct, typename="graintwin_msgs.msg.dds_.Event_"):
    header: Header
    increment: uint64
    kind: uint8
    stress_before: float64
    stress_after: float64
    grains: sequence[uint32]
    displacement: sequence[float64]


@dataclass
class Fabric(IdlStruct, typename="graintwin_msgs.msg.dds_.Fabric_"):
    header: Header
    increment: uint64
    contacts: uint32
    grain_contacts: uint32
    mean_normal_force: float64
    mean_tangential_force: float64
    fabric: array[float64, 9]
    force_fabric: array[float64, 9]
    shear_fabric: array[float64, 9]
    contact_anisotropy: float64
    normal_anisotropy: float64
    tangential_anisotropy: float64
    cone_all: array[float64, 3]
    cone_largest: array[float64, 3]
    chain_share: float64
    chain_threshold: float64
    chain_contacts: uint32
    chain_grains: uint32
    chains: uint32
    largest_chain: uint32
    chain_load: float64
    chain_spans: array[bool, 3]
    strongest_path: array[float64, 3]
    force_histogram: sequence[uint32]
    mobilised_histogram: sequence[uint32]
    angle_count: sequence[uint32]
    angle_normal: sequence[float64]
    angle_tangential: sequence[float64]
    angle_shear: sequence[float64]
    angle_fitted: array[float64, 3]
    angle_predicted: array[float64, 3]
    coordination: sequence[uint32]
    interior_coordination: sequence[uint32]


@dataclass
class Bonds(IdlStruct, typename="graintwin_msgs.msg.dds_.Bonds_"):
    header: Header
    increment: uint64
    chunk: uint32
    chunk_count: uint32
    tensile_strength: float64
    shear_strength: float64
    first: sequence[uint32]
    second: sequence[uint32]
    condition: sequence[uint8]
    share: sequence[float64]
    radius: sequence[float64]
    position: sequence[float64]
    normal: sequence[float64]
    normal_force: sequence[float64]
    tangential_force: sequence[float64]
    torsion: sequence[float64]
    strength_use: sequence[float64]


@dataclass
class Cracks(IdlStruct, typename="graintwin_msgs.msg.dds_.Cracks_"):
    header: Header
    increment: uint64
    chunk: uint32
    chunk_count: uint32
    intact: uint32
    broken_by_tension: uint32
    broken_by_shear: uint32
    first: sequence[uint32]
    second: sequence[uint32]
    mode: sequence[uint8]
    substep: sequence[uint32]
    position: sequence[float64]
    normal: sequence[float64]
    normal_force: sequence[float64]
    tangential_force: sequence[float64]
    torsion: sequence[float64]
    overload: sequence[float64]
    stress_before: sequence[float64]
    stress_after: sequence[float64]
    energy_released: sequence[float64]


@dataclass
class Rearrangement(IdlStruct, typename="graintwin_msgs.msg.dds_.Rearrangement_"):
    header: Header
    increment: uint64
    event: uint32
    chunk: uint32
    chunk_count: uint32
    kind: uint8
    stress_before: float64
    stress_after: float64
    energy_before: float64
    energy_after: float64
    grains: sequence[uint32]
    displacement: sequence[float64]
    rotation: sequence[float64]
    lost_first: sequence[uint32]
    lost_second: sequence[uint32]
    made_first: sequence[uint32]
    made_second: sequence[uint32]


@dataclass
class Report(IdlStruct, typename="graintwin_msgs.msg.dds_.Report_"):
    header: Header
    session: str
    sequence: uint64
    increment: uint64
    disposition: uint8
    substeps: uint32
    text: str


@dataclass
class WallTargets(IdlStruct, typename="graintwin_msgs.msg.dds_.WallTargets_"):
    header: Header
    session: str
    sequence: uint64
    mode: uint8
    control: array[uint8, 6]
    value: array[float64, 6]


@dataclass
class Dissociation(IdlStruct, typename="graintwin_msgs.msg.dds_.Dissociation_"):
    header: Header
    session: str
    sequence: uint64
    mode: uint8
    saturation_loss: float64
    pore_pressure: float64
    biot: float64


@dataclass
class ShearCommand(IdlStruct, typename="graintwin_msgs.msg.dds_.ShearCommand_"):
    header: Header
    session: str
    sequence: uint64
    mode: uint8
    tilt: float64
    control: array[uint8, 6]
    value: array[float64, 6]


@dataclass
class ShearState(IdlStruct, typename="graintwin_msgs.msg.dds_.ShearState_"):
    header: Header
    increment: uint64
    tilt: float64
    strain: array[float64, 4]
    inner_stress: array[float64, 4]
    inner_grains: uint32
    stress_direction: float64
    strain_direction: float64
    mean_rotation: float64


@dataclass
class Hydrate(IdlStruct, typename="graintwin_msgs.msg.dds_.Hydrate_"):
    header: Header
    increment: uint64
    saturation: float64
    present_saturation: float64
    pore_pressure: float64
    effective_stress: float64
    total_stress: float64
    porosity: float64
    pore_fraction: float64


@dataclass
class PlaneState(IdlStruct, typename="graintwin_msgs.msg.dds_.PlaneState_"):
    header: Header
    increment: uint64
    mean_diameter: float64
    tilt: float64
    margin: float64
    area: float64
    stress: array[float64, 3]
    principal_stress: array[float64, 2]
    principal_direction: float64
    contacts_per_grain: float64
    contact_density: float64
    share_broken: float64
    mean_rotation: float64
    network_strain: array[float64, 3]
    contact_strain: array[float64, 2]
    polar_contacts: sequence[uint32]
    polar_normal: sequence[float64]
    polar_shear: sequence[float64]
    ring_radius: sequence[float64]
    ring_radial_stress: sequence[float64]
    ring_hoop_stress: sequence[float64]
    ring_contact_density: sequence[float64]


@dataclass
class Discrepancy(IdlStruct, typename="graintwin_msgs.msg.dds_.Discrepancy_"):
    header: Header
    increment: uint64
    valid: array[bool, 6]
    twin_force: array[float64, 6]
    rig_force: array[float64, 6]
    difference: array[float64, 6]
    delay: array[float64, 6]


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs.msg.dds_.KeyValue_"):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs.msg.dds_.DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs.msg.dds_.DiagnosticArray_"):
    header: Header
    status: sequence[DiagnosticStatus]


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs.msg.dds_.Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Transform(IdlStruct, typename="geometry_msgs.msg.dds_.Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs.msg.dds_.TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs.msg.dds_.TFMessage_"):
    transforms: sequence[TransformStamped]


@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs.msg.dds_.Clock_"):
    clock: Time


@dataclass
class PointField(IdlStruct, typename="sensor_msgs.msg.dds_.PointField_"):
    name: str
    offset: uint32
    datatype: uint8
    count: uint32


@dataclass
class PointCloud2(IdlStruct, typename="sensor_msgs.msg.dds_.PointCloud2_"):
    header: Header
    height: uint32
    width: uint32
    fields: sequence[PointField]
    is_bigendian: bool
    point_step: uint32
    row_step: uint32
    data: sequence[uint8]
    is_dense: bool


@dataclass
class Point(IdlStruct, typename="geometry_msgs.msg.dds_.Point_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs.msg.dds_.Pose_"):
    position: Point
    orientation: Quaternion


@dataclass
class ColorRGBA(IdlStruct, typename="std_msgs.msg.dds_.ColorRGBA_"):
    r: float32
    g: float32
    b: float32
    a: float32


@dataclass
class Duration(IdlStruct, typename="builtin_interfaces.msg.dds_.Duration_"):
    sec: int32
    nanosec: uint32


@dataclass
class CompressedImage(IdlStruct, typename="sensor_msgs.msg.dds_.CompressedImage_"):
    header: Header
    format: str
    data: sequence[uint8]


@dataclass
class UVCoordinate(IdlStruct, typename="visualization_msgs.msg.dds_.UVCoordinate_"):
    u: float32
    v: float32


@dataclass
class MeshFile(IdlStruct, typename="visualization_msgs.msg.dds_.MeshFile_"):
    filename: str
    data: sequence[uint8]


@dataclass
class Marker(IdlStruct, typename="visualization_msgs.msg.dds_.Marker_"):
    header: Header
    ns: str
    id: int32
    type: int32
    action: int32
    pose: Pose
    scale: Vector3
    color: ColorRGBA
    lifetime: Duration
    frame_locked: bool
    points: sequence[Point]
    colors: sequence[ColorRGBA]
    texture_resource: str
    texture: CompressedImage
    uv_coordinates: sequence[UVCoordinate]
    text: str
    mesh_resource: str
    mesh_file: MeshFile
    mesh_use_embedded_materials: bool


@dataclass
class MarkerArray(IdlStruct, typename="visualization_msgs.msg.dds_.MarkerArray_"):
    markers: sequence[Marker]


class Out(NamedTuple):
    """What the node publishes on one topic; depth is the peer's, deep enough for its bursts."""

    kind: type
    depth: int
    latched: bool = False


WALLS = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")

OUT = {
    "wall_forces": Out(WallForces, 20000),
    **{f"wall/{wall}/wrench": Out(WrenchStamped, 20000) for wall in WALLS},
    "wall_states": Out(JointState, 20000),
    "state": Out(PackState, 20000),
    "moduli": Out(Moduli, 20000, latched=True),
    "tangent": Out(Tangent, 20000, latched=True),
    "contact_network": Out(ContactNetwork, 2000),
    "grain_motion": Out(GrainMotion, 2000),
    "events": Out(Event, 20000),
    "fabric": Out(Fabric, 20000),
    "hydrate": Out(Hydrate, 20000),
    "shear_state": Out(ShearState, 20000),
    "plane_state": Out(PlaneState, 20000),
    "bonds": Out(Bonds, 2000),
    "cracks": Out(Cracks, 20000),
    "rearrangements": Out(Rearrangement, 20000),
    "report": Out(Report, 20000),
}


# What the node draws, for those who look.
PICTURES = {"grains": Out(PointCloud2, 2), "markers": Out(MarkerArray, 2)}


def dds_name(topic):
    """The DDS name of a topic of the node."""
    return f"rt/graintwin/{topic}"


def qos(depth, latched=False):
    """Reliable, keep last, as the contract's table says."""
    durability = Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile
    return Qos(
        Policy.Reliability.Reliable(duration(seconds=10)),
        durability,
        Policy.History.KeepLast(depth),
    )
