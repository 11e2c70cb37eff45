//! Messages as postcard bytes, with every number's place in them: whatever the messages are, their numbers can be
//! looked at and put in others' place.

use serde::ser::{self, Serialize};
use std::fmt;

/// What kind of number stands at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A byte: u8, i8, bool, or whether there is something.
    Byte,
    /// A variable number of bytes: other integers, lengths, which variant it is.
    Varint,
    /// f32.
    Single,
    /// f64.
    Double,
}

/// A number in the bytes of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumberSpan {
    /// What it is.
    pub kind: Kind,
    /// Where it begins.
    pub at: usize,
    /// Bytes that it takes.
    pub length: usize,
}

/// Postcard bytes of a message and where its numbers are; kept, so that its memory is used again.
#[derive(Debug, Default)]
pub struct Wire {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// The numbers in them, in order.
    pub numbers: Vec<NumberSpan>,
}

impl Wire {
    /// Of another message.
    pub fn write(&mut self, message: &impl Serialize) {
        self.bytes.clear();
        self.numbers.clear();
        message
            .serialize(&mut *self)
            .expect("messages have no maps and no sequences of unknown length");
    }

    /// Whether all numbers of `message` are finite.
    pub fn finite(&mut self, message: &impl Serialize) -> bool {
        self.write(message);
        self.numbers.iter().all(|place| {
            let bytes = &self.bytes[place.at..place.at + place.length];
            match place.kind {
                Kind::Double => f64::from_le_bytes(bytes.try_into().expect("8 bytes")).is_finite(),
                Kind::Single => f32::from_le_bytes(bytes.try_into().expect("4 bytes")).is_finite(),
                Kind::Byte | Kind::Varint => true,
            }
        })
    }

    fn put(&mut self, kind: Kind, bytes: &[u8]) {
        self.numbers.push(NumberSpan {
            kind,
            at: self.bytes.len(),
            length: bytes.len(),
        });
        self.bytes.extend_from_slice(bytes);
    }

    fn varint(&mut self, value: u64) {
        let mut bytes = [0; 10];
        let length = varint(value, &mut bytes);
        self.put(Kind::Varint, &bytes[..length]);
    }
}

/// Writes a variable number of bytes; says how many.
pub fn varint(mut value: u64, bytes: &mut [u8; 10]) -> usize {
    let mut length = 0;
    loop {
        bytes[length] = value as u8 & 0x7f;
        value >>= 7;
        length += 1;
        if value == 0 {
            return length;
        }
        bytes[length - 1] |= 0x80;
    }
}

fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// There is no such type in the table.
#[derive(Debug)]
pub struct NotInTheTable;

impl fmt::Display for NotInTheTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a type that no message has")
    }
}

impl std::error::Error for NotInTheTable {}

impl ser::Error for NotInTheTable {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self
    }
}

type Done = Result<(), NotInTheTable>;

macro_rules! numbers {
    ($($name:ident($type:ty) = $self:ident, $value:ident => $put:expr;)+) => {
        $(fn $name($self, $value: $type) -> Done {
            $put;
            Ok(())
        })+
    };
}

impl<'a> ser::Serializer for &'a mut Wire {
    type Ok = ();
    type Error = NotInTheTable;
    type SerializeSeq = &'a mut Wire;
    type SerializeTuple = &'a mut Wire;
    type SerializeTupleStruct = &'a mut Wire;
    type SerializeTupleVariant = &'a mut Wire;
    type SerializeMap = ser::Impossible<(), NotInTheTable>;
    type SerializeStruct = &'a mut Wire;
    type SerializeStructVariant = &'a mut Wire;

    numbers! {
        serialize_bool(bool) = self, value => self.put(Kind::Byte, &[value.into()]);
        serialize_u8(u8) = self, value => self.put(Kind::Byte, &[value]);
        serialize_i8(i8) = self, value => self.put(Kind::Byte, &value.to_le_bytes());
        serialize_u16(u16) = self, value => self.varint(value.into());
        serialize_u32(u32) = self, value => self.varint(value.into());
        serialize_u64(u64) = self, value => self.varint(value);
        serialize_i16(i16) = self, value => self.varint(zigzag(value.into()));
        serialize_i32(i32) = self, value => self.varint(zigzag(value.into()));
        serialize_i64(i64) = self, value => self.varint(zigzag(value));
        serialize_f32(f32) = self, value => self.put(Kind::Single, &value.to_le_bytes());
        serialize_f64(f64) = self, value => self.put(Kind::Double, &value.to_le_bytes());
        serialize_char(char) = self, value => self.serialize_str(value.encode_utf8(&mut [0; 4]))?;
        serialize_str(&str) = self, value => self.serialize_bytes(value.as_bytes())?;
    }

    fn serialize_bytes(self, value: &[u8]) -> Done {
        self.varint(value.len() as u64);
        self.bytes.extend_from_slice(value);
        Ok(())
    }

    fn serialize_none(self) -> Done {
        self.put(Kind::Byte, &[0]);
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Done {
        self.put(Kind::Byte, &[1]);
        value.serialize(self)
    }

    fn serialize_unit(self) -> Done {
        Ok(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Done {
        Ok(())
    }

    fn serialize_unit_variant(self, _: &'static str, variant: u32, _: &'static str) -> Done {
        self.varint(variant.into());
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Done {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        value: &T,
    ) -> Done {
        self.varint(variant.into());
        value.serialize(self)
    }

    fn serialize_seq(self, length: Option<usize>) -> Result<Self, NotInTheTable> {
        self.varint(length.ok_or(NotInTheTable)? as u64);
        Ok(self)
    }

    fn serialize_tuple(self, _: usize) -> Result<Self, NotInTheTable> {
        Ok(self)
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Self, NotInTheTable> {
        Ok(self)
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self, NotInTheTable> {
        self.varint(variant.into());
        Ok(self)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, NotInTheTable> {
        Err(NotInTheTable)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self, NotInTheTable> {
        Ok(self)
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self, NotInTheTable> {
        self.varint(variant.into());
        Ok(self)
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

macro_rules! parts {
    ($($trait:ident::$name:ident($($key:ty)?);)+) => {
        $(impl ser::$trait for &mut Wire {
            type Ok = ();
            type Error = NotInTheTable;

            fn $name<T: Serialize + ?Sized>(&mut self, $(_: $key,)? value: &T) -> Done {
                value.serialize(&mut **self)
            }

            fn end(self) -> Done {
                Ok(())
            }
        })+
    };
}

parts! {
    SerializeSeq::serialize_element();
    SerializeTuple::serialize_element();
    SerializeTupleStruct::serialize_field();
    SerializeTupleVariant::serialize_field();
    SerializeStruct::serialize_field(&'static str);
    SerializeStructVariant::serialize_field(&'static str);
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::io::{MOTORS, SIDES};
    use shared::protocol::{
        Datagram, LOAD_EVENTS, MotionSample, PathAction, PathEvent, Refusal, Request, Response,
    };
    use shared::state::State;

    fn same(message: &impl Serialize) -> Vec<NumberSpan> {
        let mut wire = Wire::default();
        wire.write(message);
        assert_eq!(wire.bytes, postcard::to_stdvec(message).expect("bytes"));
        wire.numbers
    }

    #[test]
    fn bytes_are_those_of_postcard_and_places_those_of_their_numbers() {
        let event = PathEvent {
            s_mm: -1.5,
            action: PathAction::Power { side: 1, watt: 300.0 },
        };
        let events = std::iter::repeat_n(event, LOAD_EVENTS).collect();
        // Which request, how many; then s, which action, side and power of each.
        let numbers = same(&Request::LoadEvents(events));
        assert_eq!(numbers.len(), 2 + 4 * LOAD_EVENTS);
        assert_eq!(
            numbers[2..6].iter().map(|place| place.kind).collect::<Vec<_>>(),
            [Kind::Double, Kind::Varint, Kind::Byte, Kind::Double]
        );
        same(&Request::Hello {
            schema_hash: u64::MAX,
        });
        same(&Response::Refused(Refusal::WrongState {
            state: State::Running,
        }));
        same(&Request::Status);
    }

    #[test]
    fn a_number_that_is_not_finite_is_found_wherever_it_is() {
        let mut sample = MotionSample {
            tick: 1,
            time_us: 2,
            state: State::Idle,
            path_id: 3,
            s_mm: 0.0,
            speed_mm_s: 0.0,
            beams: [false; SIDES],
            outputs: 0,
            inputs: 0,
            levels: [0.0; 4],
            switched: shared::io::SwitchedLines::NONE,
            axes: [0.0; 6],
            truth: Some([0.0; MOTORS]),
            following_error: [0.0; MOTORS],
            skew_mm: 0.0,
            load: None,
        };
        let mut wire = Wire::default();
        assert!(wire.finite(&sample));
        sample.following_error[6] = f32::INFINITY;
        assert!(!wire.finite(&sample));
        sample.following_error[6] = 0.0;
        sample.truth = Some([f64::NAN; MOTORS]);
        assert!(!wire.finite(&sample));
        let request = Datagram::ClockRequest(shared::protocol::ClockRequest { asked_us: 5 });
        assert!(wire.finite(&request));
    }
}
