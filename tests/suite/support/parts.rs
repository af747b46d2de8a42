//! Logs taken apart into their records, and put together again.

use flightcam::log::record::{Records, push_record, serialize};
use mcap::records::{Footer, op};

/// A log as its records: those before DataEnd, and those of the summary (without its offsets).
pub struct Parts {
    pub data: Vec<(u8, Vec<u8>)>,
    pub data_section_crc: u32,
    pub summary: Vec<(u8, Vec<u8>)>,
}

impl Parts {
    /// The records of a log that has no closing magic.
    pub fn records(log: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
        let records = Records::new(&log[mcap::MAGIC.len()..]);
        records
            .map(|record| record.expect("a whole record"))
            .map(|record| (record.opcode, record.body))
    }

    pub fn of(log: &[u8]) -> Self {
        let mut parts = Self {
            data: Vec::new(),
            data_section_crc: 0,
            summary: Vec::new(),
        };
        let mut in_data = true;
        for (opcode, body) in Self::records(&log[..log.len() - mcap::MAGIC.len()]) {
            let kept = (opcode, body.to_vec());
            match opcode {
                op::DATA_END => {
                    in_data = false;
                    parts.data_section_crc = u32::from_le_bytes(body.try_into().expect("a CRC"));
                }
                op::FOOTER | op::SUMMARY_OFFSET => {}
                _ if in_data => parts.data.push(kept),
                _ => parts.summary.push(kept),
            }
        }
        parts
    }

    /// The log again. Checksums of what may have been changed are left out.
    pub fn join(&self) -> Vec<u8> {
        let mut log = mcap::MAGIC.to_vec();
        for (opcode, body) in &self.data {
            push_record(&mut log, *opcode, body);
        }
        push_record(&mut log, op::DATA_END, &self.data_section_crc.to_le_bytes());
        let summary_start = match self.summary.is_empty() {
            true => 0,
            false => log.len() as u64,
        };
        for (opcode, body) in &self.summary {
            push_record(&mut log, *opcode, body);
        }
        let footer = Footer {
            summary_start,
            ..Footer::default()
        };
        push_record(&mut log, op::FOOTER, &serialize(&footer));
        log.extend_from_slice(mcap::MAGIC);
        log
    }
}

/// A log up to the end of its last whole record.
pub fn whole_records(log: &[u8]) -> &[u8] {
    let magic = mcap::MAGIC.len().min(log.len());
    let torn = Records::new(&log[magic..]).find_map(Result::err);
    &log[..torn.map_or(log.len(), |torn| magic + torn.offset)]
}
