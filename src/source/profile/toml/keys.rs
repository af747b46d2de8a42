//! Which keys a table may have: those of the types that it is read into.

use std::{cell::Cell, marker::PhantomData};

use serde::{
    Deserializer,
    de::{DeserializeOwned, Error as _, Visitor, value::Error},
    forward_to_deserialize_any,
};

/// The keys of a table that is read as this type; none if it is not read as a struct or an enum.
pub fn of<T: DeserializeOwned>() -> &'static [&'static str] {
    let keys = Cell::new(&[][..]);
    // Nothing is read: the type only says what it would ask for.
    let _ = T::deserialize(Asked {
        keys: &keys,
        lifetime: PhantomData,
    });
    keys.get()
}

/// Notes which keys a type asks for.
struct Asked<'a, 'de> {
    keys: &'a Cell<&'static [&'static str]>,
    lifetime: PhantomData<&'de ()>,
}

impl<'de> Deserializer<'de> for Asked<'_, 'de> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(Error::custom("nothing is there"))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        _visitor: V,
    ) -> Result<V::Value, Error> {
        self.keys.set(fields);
        Err(Error::custom("nothing is there"))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        _visitor: V,
    ) -> Result<V::Value, Error> {
        self.keys.set(variants);
        Err(Error::custom("nothing is there"))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map identifier ignored_any
    }
}
