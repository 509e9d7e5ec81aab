//! What a serde type is made of: its fields in order with the primitive each asks for, found by
//! letting it deserialize itself from a source that only notes the questions and answers zero.

use serde::de::{self, DeserializeOwned, DeserializeSeed, SeqAccess, Visitor};

/// One primitive or sequence, with the path of field names that leads to it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leaf {
    /// Field names joined by dots.
    pub path: String,
    /// ROS name of the primitive; `[]` behind it for a sequence.
    pub kind: String,
}

/// The leaves of `T`, in the order they go over the wire.
pub fn leaves<T: DeserializeOwned>() -> Vec<Leaf> {
    let mut tracer = Tracer { path: Vec::new(), in_sequence: false, leaves: Vec::new() };
    T::deserialize(&mut tracer).expect("zeros are a value of every message");
    tracer.leaves
}

struct Tracer {
    path: Vec<&'static str>,
    in_sequence: bool,
    leaves: Vec<Leaf>,
}

impl Tracer {
    fn note(&mut self, kind: &str) {
        let brackets = if self.in_sequence { "[]" } else { "" };
        self.leaves.push(Leaf { path: self.path.join("."), kind: format!("{kind}{brackets}") });
    }
}

macro_rules! primitive {
    ($($method:ident $visit:ident $zero:expr, $kind:literal;)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
            self.note($kind);
            visitor.$visit($zero)
        })*
    };
}

impl<'de> de::Deserializer<'de> for &mut Tracer {
    type Error = de::value::Error;

    primitive! {
        deserialize_bool visit_bool false, "bool";
        deserialize_i8 visit_i8 0, "int8";
        deserialize_i16 visit_i16 0, "int16";
        deserialize_i32 visit_i32 0, "int32";
        deserialize_i64 visit_i64 0, "int64";
        deserialize_u8 visit_u8 0, "uint8";
        deserialize_u16 visit_u16 0, "uint16";
        deserialize_u32 visit_u32 0, "uint32";
        deserialize_u64 visit_u64 0, "uint64";
        deserialize_f32 visit_f32 0.0, "float32";
        deserialize_f64 visit_f64 0.0, "float64";
        deserialize_str visit_str "", "string";
        deserialize_string visit_str "", "string";
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        visitor.visit_seq(Fields { tracer: self, fields: fields.iter() })
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        visitor.visit_seq(OneElement { tracer: self, done: false })
    }

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value, Self::Error> {
        Err(de::Error::custom(format!(
            "`{}` is of a kind that ROS messages do not have",
            self.path.join(".")
        )))
    }

    serde::forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf option unit unit_struct newtype_struct tuple tuple_struct map enum identifier
        ignored_any
    }
}

struct Fields<'a> {
    tracer: &'a mut Tracer,
    fields: std::slice::Iter<'static, &'static str>,
}

impl<'de> SeqAccess<'de> for Fields<'_> {
    type Error = de::value::Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Self::Error> {
        let Some(field) = self.fields.next() else { return Ok(None) };
        self.tracer.path.push(field);
        let value = seed.deserialize(&mut *self.tracer)?;
        self.tracer.path.pop();
        Ok(Some(value))
    }
}

struct OneElement<'a> {
    tracer: &'a mut Tracer,
    done: bool,
}

impl<'de> SeqAccess<'de> for OneElement<'_> {
    type Error = de::value::Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Self::Error> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        let outer = std::mem::replace(&mut self.tracer.in_sequence, true);
        let value = seed.deserialize(&mut *self.tracer)?;
        self.tracer.in_sequence = outer;
        Ok(Some(value))
    }
}
