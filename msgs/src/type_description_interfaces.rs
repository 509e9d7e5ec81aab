//! Types of the ROS package `type_description_interfaces`: types described (REP 2016).

use serde::{Deserialize, Serialize};

use crate::message::{RosService, ros_message, ros_part};

/// Type of a field.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct FieldType {
    /// A number of REP 2016: 1 for another type, 2 to 22 for primitives and strings; 48 more for an
    /// array, 96 for a sequence with a bound, 144 for one without.
    pub type_id: u8,
    /// Length of an array, or bound of a sequence; else 0.
    pub capacity: u64,
    /// Bound of a string; else 0.
    pub string_capacity: u64,
    /// The other type, as in `std_msgs/msg/Header`; else empty.
    pub nested_type_name: String,
}

/// A field of a type.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its type.
    pub r#type: FieldType,
    /// The value that it has where nothing is said; empty if there is none.
    pub default_value: String,
}

/// A type without those that it refers to.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct IndividualTypeDescription {
    /// Full name, as in `sensor_msgs/msg/JointState`.
    pub type_name: String,
    /// In the order of the wire.
    pub fields: Vec<Field>,
}

/// A type, and those that it refers to.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TypeDescription {
    /// The type itself.
    pub type_description: IndividualTypeDescription,
    /// Those that it refers to at any depth, each once, by name.
    pub referenced_type_descriptions: Vec<IndividualTypeDescription>,
}

/// The file that a type is defined in.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TypeSource {
    /// Full name.
    pub type_name: String,
    /// `msg`, `srv` or `action`; `implicit` for the parts of services and actions.
    pub encoding: String,
    /// Its text; empty for parts.
    pub raw_file_contents: String,
}

/// A key with its value.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct KeyValue {
    /// The key.
    pub key: String,
    /// The value.
    pub value: String,
}

/// Asks a node for a type that it uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GetTypeDescription;

/// Request of [`GetTypeDescription`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetTypeDescriptionRequest {
    /// Full name. The hash decides.
    pub type_name: String,
    /// The type's hash, `RIHS01_...`.
    pub type_hash: String,
    /// Whether the texts of the files are wanted too.
    pub include_type_sources: bool,
}

/// Response of [`GetTypeDescription`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetTypeDescriptionResponse {
    /// The type is described below.
    pub successful: bool,
    /// Why it is not.
    pub failure_reason: String,
    /// The type.
    pub type_description: TypeDescription,
    /// The files, the type's own first.
    pub type_sources: Vec<TypeSource>,
    /// What else there is to say.
    pub extra_information: Vec<KeyValue>,
}

impl RosService for GetTypeDescription {
    const PACKAGE: &'static str = "type_description_interfaces";
    const NAME: &'static str = "GetTypeDescription";
    type Request = GetTypeDescriptionRequest;
    type Response = GetTypeDescriptionResponse;
}

ros_message!(
    FieldType,
    "type_description_interfaces",
    "../standard/type_description_interfaces/FieldType.msg",
    "RIHS01_a70b6dd919645a03a3586f7f821defbc886ea3e531a1d95cc0f380a3973ccaa6",
    []
);
ros_message!(
    Field,
    "type_description_interfaces",
    "../standard/type_description_interfaces/Field.msg",
    "RIHS01_c0b01379cd4226281285ccaf6be46653968f855f7c5e41614ff5d7a854efef7c",
    [FieldType]
);
ros_message!(
    IndividualTypeDescription,
    "type_description_interfaces",
    "../standard/type_description_interfaces/IndividualTypeDescription.msg",
    "RIHS01_55c827d86c3c141bdd318fe6c22e11190e4d3b37c8f4f9751a084aa05ce96560",
    [Field, FieldType]
);
ros_message!(
    TypeDescription,
    "type_description_interfaces",
    "../standard/type_description_interfaces/TypeDescription.msg",
    "RIHS01_739f2508c9fa3a6f330913ff5b9d25fb74159a077da71e1087f51a60c12a080b",
    [IndividualTypeDescription, Field, FieldType]
);
ros_message!(
    TypeSource,
    "type_description_interfaces",
    "../standard/type_description_interfaces/TypeSource.msg",
    "RIHS01_faeaec7596c04ecf5b6e99ad225e4c7cbb997ad5435f793526fb3984d011aae5",
    []
);
ros_message!(
    KeyValue,
    "type_description_interfaces",
    "../standard/type_description_interfaces/KeyValue.msg",
    "RIHS01_274fe56bf14f33c7512e34c646a37579ee36779f745f049a9760763e817f0c42",
    []
);
ros_part!(
    GetTypeDescriptionRequest,
    "type_description_interfaces",
    "srv",
    "GetTypeDescription_Request",
    "../standard/type_description_interfaces/GetTypeDescription.srv",
    0,
    "RIHS01_470f56ccbcf13d55c78c8b735fb12da03e639e5acded994426c89d94778d9e28",
    []
);
ros_part!(
    GetTypeDescriptionResponse,
    "type_description_interfaces",
    "srv",
    "GetTypeDescription_Response",
    "../standard/type_description_interfaces/GetTypeDescription.srv",
    1,
    "RIHS01_648c49d976240861a482f961c5621ddd0d2135d8cce6f297a76d4f6376d93b75",
    [TypeDescription, IndividualTypeDescription, Field, FieldType, TypeSource, KeyValue]
);
