//! Files that may be recordings, for the targets of reading and recovering.
//!
//! The first byte chooses what the rest is: a file, changes to a good file, or
//! the messages of one.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::{env, fs, process};

use mcap::records::{MessageHeader, Metadata};

static FILE: LazyLock<PathBuf> =
    LazyLock::new(|| env::temp_dir().join(format!("fcc-fuzz-{}.mcap", process::id())));
static GOOD: LazyLock<Vec<u8>> = LazyLock::new(|| written(&[&[8, 1], &[8, 2, 24, 1], &[]]));

/// A recording with these messages, alternately records and events.
fn written(messages: &[&[u8]]) -> Vec<u8> {
    let options = mcap::WriteOptions::new()
        .profile("fcc.v2")
        .compression(None)
        .compression_threads(0);
    let mut writer = options.create(Cursor::new(Vec::new())).expect("memory");
    let metadata = BTreeMap::from([("aircraft".to_owned(), "fuzz".to_owned())]);
    let about = Metadata {
        name: "fcc.recording".to_owned(),
        metadata,
    };
    writer.write_metadata(&about).expect("memory");
    let channels = ["/fcc/record", "/fcc/event"].map(|topic| {
        writer
            .add_channel(0, topic, "protobuf", &BTreeMap::new())
            .expect("memory")
    });
    for (sequence, (message, channel_id)) in
        (0..).zip(messages.iter().zip(channels.into_iter().cycle()))
    {
        let header = MessageHeader {
            channel_id,
            sequence,
            log_time: 0,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, message).expect("memory");
    }
    writer.finish().expect("memory");
    writer.into_inner().into_inner()
}

/// Writes the file that this input describes; its path and its size.
pub fn file_of(input: &[u8]) -> Option<(&'static Path, usize)> {
    let (kind, rest) = input.split_first()?;
    let file = match kind % 3 {
        0 => rest.to_vec(),
        1 => {
            let mut file = GOOD.clone();
            for change in rest.chunks_exact(3) {
                let place = usize::from(u16::from_le_bytes([change[0], change[1]]));
                let length = file.len();
                file[place % length] = change[2];
            }
            file.truncate(file.len() - rest.len() % 3 * 20);
            file
        }
        _ => written(&rest.chunks(40).collect::<Vec<_>>()),
    };
    fs::write(&*FILE, &file).expect("a temporary file");
    Some((&FILE, file.len()))
}
