//! A parameter's value, as ROS 2 knows it.

/// A value of a parameter: the types of `rcl_interfaces/msg/ParameterValue`. Serialised, it is the
/// bare value.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "yaml", derive(serde::Serialize), serde(untagged))]
pub enum ParameterValue {
    /// None at all.
    NotSet,
    /// Yes or no.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A real number.
    Double(f64),
    /// A text.
    String(String),
    /// Bytes.
    ByteArray(Vec<u8>),
    /// Yes or no, several times.
    BooleanArray(Vec<bool>),
    /// Whole numbers.
    IntegerArray(Vec<i64>),
    /// Real numbers.
    DoubleArray(Vec<f64>),
    /// Texts.
    StringArray(Vec<String>),
}

impl ParameterValue {
    /// The type's name as rclcpp spells it.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::NotSet => "not set",
            Self::Boolean(_) => "bool",
            Self::Integer(_) => "integer",
            Self::Double(_) => "double",
            Self::String(_) => "string",
            Self::ByteArray(_) => "byte_array",
            Self::BooleanArray(_) => "bool_array",
            Self::IntegerArray(_) => "integer_array",
            Self::DoubleArray(_) => "double_array",
            Self::StringArray(_) => "string_array",
        }
    }
}
