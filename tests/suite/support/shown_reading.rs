//! What viewers are shown, read from messages by their definitions alone.

use flightcam::{
    derived::visual::Shown,
    messages::{Format, Message, MessageDefinition, Topic},
};
use prost::Message as _;
use prost_reflect::{DescriptorPool, DynamicMessage, SerializeOptions};
use serde_json::Value;

use super::ros_walk;

fn encode(format: &Format, shown: &Shown) -> Vec<u8> {
    // Alignment counts from the message's own start.
    let mut out = b"before".to_vec();
    format.encode(&Message::from(shown), &mut out);
    out.split_off(b"before".len())
}

/// The topic of a message and its type.
pub fn topic_and_type(format: &Format, shown: &Shown) -> (Topic, Option<MessageDefinition>) {
    let topic = format.topic(&Message::from(shown));
    (topic, format.definition(topic))
}

/// The fields of a message: those of protobuf's JSON mapping, or of the definition. NaN is null.
pub fn read(format: &Format, shown: &Shown) -> Value {
    let (_, definition) = topic_and_type(format, shown);
    let definition = definition.expect("a type");
    let payload = encode(format, shown);
    match definition.message_encoding {
        "protobuf" => protobuf(&definition, &payload),
        "json" => serde_json::from_slice(&payload).expect("JSON"),
        _ => {
            let text = std::str::from_utf8(definition.data).expect("UTF-8");
            let types = ros_walk::types(definition.name, text);
            ros_walk::deserialize(&types, &ros_walk::short(definition.name), &payload)
        }
    }
}

fn protobuf(definition: &MessageDefinition, payload: &[u8]) -> Value {
    let pool = DescriptorPool::decode(definition.data).expect("descriptors");
    let descriptor = pool.get_message_by_name(definition.name);
    let message = DynamicMessage::decode(descriptor.expect("the type"), payload);
    let message = message.expect("a message");
    assert_eq!(message.unknown_fields().count(), 0);
    assert_eq!(message.encoded_len(), payload.len());
    let options = SerializeOptions::new()
        .use_proto_field_name(true)
        .skip_default_fields(false);
    message
        .serialize_with_options(serde_json::value::Serializer, &options)
        .expect("JSON")
}
