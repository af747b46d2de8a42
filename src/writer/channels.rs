//! The new channels: their ids, schemas and messages.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{Channel, MessageHeader, SchemaHeader, op};

use super::{
    chunk::Batch,
    data_section::Added,
    error::{IdKind, WriteError},
};
use crate::{
    log::{
        Log,
        record::{serialize, serialize_into},
    },
    messages::{Format, Message, MessageDefinition, Topic},
};

/// Writes messages on new channels.
pub struct NewChannels<'a> {
    log: &'a Log,
    format: Format,
    channels: BTreeMap<Topic, u16>,
    messages: BTreeMap<Topic, u64>,
    /// The ids of their schemas, by name.
    schemas: BTreeMap<&'static str, u16>,
    /// The ids in use, including new ones.
    schema_ids: BTreeSet<u16>,
    channel_ids: BTreeSet<u16>,
    body: Vec<u8>,
}

impl<'a> NewChannels<'a> {
    /// Makes new channels for a log, with messages in `format`.
    pub fn new(log: &'a Log, format: Format) -> Self {
        Self {
            log,
            format,
            channels: BTreeMap::new(),
            messages: BTreeMap::new(),
            schemas: BTreeMap::new(),
            schema_ids: log.contents.schema_ids(),
            channel_ids: log.contents.channel_ids(),
            body: Vec::new(),
        }
    }

    /// Messages by topic. One without messages has no channel.
    pub fn messages(&self) -> BTreeMap<Topic, u64> {
        self.messages.clone()
    }

    /// Adds a message to the batch and, before the first of a topic, also its channel. Messages of topics that the format
    /// does not have are left out.
    ///
    /// # Errors
    /// The log has no id left for a channel.
    pub fn push(
        &mut self,
        message: &Message,
        batch: &mut Batch,
        added: &mut Added,
    ) -> Result<(), WriteError> {
        let topic = self.format.topic(message);
        let channel_id = match self.channels.get(&topic) {
            Some(&id) => id,
            None => match self.format.definition(topic) {
                Some(definition) => self.add(topic, &definition, batch, added)?,
                None => return Ok(()),
            },
        };
        let messages = self.messages.entry(topic).or_default();
        let header = MessageHeader {
            channel_id,
            // Sequence numbers wrap around, which takes a year of messages at 100 Hz.
            sequence: *messages as u32,
            log_time: message.log_time(),
            publish_time: message.publish_time(),
        };
        *messages += 1;
        self.body.clear();
        serialize_into(&mut self.body, &header);
        self.format.encode(message, &mut self.body);
        batch.push_message(header.channel_id, header.log_time, &self.body);
        Ok(())
    }

    fn add(
        &mut self,
        topic: Topic,
        definition: &MessageDefinition,
        batch: &mut Batch,
        added: &mut Added,
    ) -> Result<u16, WriteError> {
        let schema_id = self.schema(definition, batch, added)?;
        let id = take_free_id(&mut self.channel_ids, 0);
        let id = id.ok_or_else(|| no_free_id(self.log, IdKind::Channel))?;
        let channel = serialize(&Channel {
            id,
            schema_id,
            topic: topic.name().to_owned(),
            message_encoding: definition.message_encoding.to_owned(),
            metadata: self.format.channel_metadata(topic),
        });
        batch.push_definition(op::CHANNEL, &channel);
        added.channels.insert(id, channel);
        self.channels.insert(topic, id);
        Ok(id)
    }

    /// The id of a new channel's schema: that of the same schema if the log or another new channel has it, otherwise a
    /// free one.
    fn schema(
        &mut self,
        schema: &MessageDefinition,
        batch: &mut Batch,
        added: &mut Added,
    ) -> Result<u16, WriteError> {
        if let Some(&id) = self.schemas.get(schema.name) {
            return Ok(id);
        }
        let mut present = self.log.contents.definitions.schemas.values();
        let same = present.find(|present| {
            (
                present.name.as_str(),
                present.encoding.as_str(),
                present.data(),
            ) == (schema.name, schema.encoding, schema.data)
        });
        let id = match same {
            Some(same) => same.id,
            None => {
                // The schema id 0 means "no schema".
                let id = take_free_id(&mut self.schema_ids, 1);
                let id = id.ok_or_else(|| no_free_id(self.log, IdKind::Schema))?;
                let body = schema_body(id, schema);
                batch.push_definition(op::SCHEMA, &body);
                added.schemas.insert(id, body);
                id
            }
        };
        self.schemas.insert(schema.name, id);
        Ok(id)
    }
}

fn schema_body(id: u16, schema: &MessageDefinition) -> Vec<u8> {
    let mut body = serialize(&SchemaHeader {
        id,
        name: schema.name.to_owned(),
        encoding: schema.encoding.to_owned(),
    });
    // The schemas are part of the program, and short.
    body.extend_from_slice(&(schema.data.len() as u32).to_le_bytes());
    body.extend_from_slice(schema.data);
    body
}

fn no_free_id(log: &Log, kind: IdKind) -> WriteError {
    WriteError::NoFreeId {
        path: log.file.path().into(),
        kind,
    }
}

/// Takes the id above the largest in use or, if there is none, the lowest free one from `lowest` on.
fn take_free_id(used: &mut BTreeSet<u16>, lowest: u16) -> Option<u16> {
    let id = match used.last() {
        None => Some(lowest),
        Some(largest) => largest
            .checked_add(1)
            .or_else(|| (lowest..=u16::MAX).find(|id| !used.contains(id))),
    }?;
    used.insert(id);
    Some(id)
}
