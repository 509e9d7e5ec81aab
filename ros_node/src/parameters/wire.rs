//! Values and descriptors as they travel.

use ::parameters::{Declaration, ParameterValue, ValueRange};
use ros2_client::parameters::{
    NumericRange, ParameterDescriptor, ParameterType, ParameterValue as Wire, raw,
};

/// A value as ros2-client has it.
fn wire(value: ParameterValue) -> Wire {
    match value {
        ParameterValue::NotSet => Wire::NotSet,
        ParameterValue::Boolean(value) => Wire::Boolean(value),
        ParameterValue::Integer(value) => Wire::Integer(value),
        ParameterValue::Double(value) => Wire::Double(value),
        ParameterValue::String(value) => Wire::String(value),
        ParameterValue::ByteArray(value) => Wire::ByteArray(value),
        ParameterValue::BooleanArray(value) => Wire::BooleanArray(value),
        ParameterValue::IntegerArray(value) => Wire::IntegerArray(value),
        ParameterValue::DoubleArray(value) => Wire::DoubleArray(value),
        ParameterValue::StringArray(value) => Wire::StringArray(value),
    }
}

/// A value as it travels.
pub(crate) fn to_raw(value: ParameterValue) -> raw::ParameterValue {
    wire(value).into()
}

/// A value that came.
pub(crate) fn from_raw(value: raw::ParameterValue) -> ParameterValue {
    match Wire::from(value) {
        Wire::NotSet => ParameterValue::NotSet,
        Wire::Boolean(value) => ParameterValue::Boolean(value),
        Wire::Integer(value) => ParameterValue::Integer(value),
        Wire::Double(value) => ParameterValue::Double(value),
        Wire::String(value) => ParameterValue::String(value),
        Wire::ByteArray(value) => ParameterValue::ByteArray(value),
        Wire::BooleanArray(value) => ParameterValue::BooleanArray(value),
        Wire::IntegerArray(value) => ParameterValue::IntegerArray(value),
        Wire::DoubleArray(value) => ParameterValue::DoubleArray(value),
        Wire::StringArray(value) => ParameterValue::StringArray(value),
    }
}

/// The type of a value.
pub(super) fn kind(value: &ParameterValue) -> ParameterType {
    wire(value.clone()).to_parameter_type()
}

/// What a range of ROS cannot say, in words.
fn constraints(declared: &Declaration) -> String {
    let (words, range) = (declared.constraints(), declared.value_range());
    match (range.is_open() || range == ValueRange::NotZero, words.is_empty()) {
        (false, _) => words.to_owned(),
        (true, true) => range.to_string(),
        (true, false) => format!("{range}; {words}"),
    }
}

/// A declaration as `describe_parameters` tells it.
pub(super) fn descriptor(declared: &Declaration) -> raw::ParameterDescriptor {
    ParameterDescriptor {
        name: declared.name().to_owned(),
        param_type: kind(declared.default_value()),
        description: declared.description().to_owned(),
        additional_constraints: constraints(declared),
        read_only: declared.is_read_only(),
        dynamic_typing: false,
        range: match declared.value_range() {
            ValueRange::Any | ValueRange::NotZero => NumericRange::NotSpecified,
            // ROS has no range that is open at one end: a bound of 1.8e308 would be shown.
            range if range.is_open() => NumericRange::NotSpecified,
            ValueRange::Double(from_value, to_value) => {
                NumericRange::FloatingPointRange { from_value, to_value, step: 0.0 }
            }
            ValueRange::Integer(from_value, to_value) => {
                NumericRange::IntegerRange { from_value, to_value, step: 1 }
            }
            // From one to the other in a single step.
            ValueRange::Either(from_value, to_value) => {
                let step = to_value.saturating_sub(from_value);
                NumericRange::IntegerRange { from_value, to_value, step }
            }
        },
    }
    .into()
}
