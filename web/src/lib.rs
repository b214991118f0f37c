//! Surefoot's compiler as a module of WebAssembly, with an interface of plain memory. `npm/surefoot.js` calls it.
//!
//! A request and an answer have one form: the length of a JSON text as four bytes, the JSON, and bytes whose lengths the JSON has as `blobs`. The caller takes
//! room by [`reserve`], writes the request there and calls [`run`]; the answer begins with its own length as four bytes. After a trap no memory of this
//! module is sound: the caller makes a new one, and may read why from [`trapped`].

mod found;
mod request;

pub use request::answer;

use serde_json::{Value, json};
use std::cell::RefCell;
use std::hint::black_box;
use std::sync::Once;
use surefoot_compiler::Memory;

/// What goes in or out: data, and bytes beside them.
pub struct Parcel {
    /// The data.
    pub json: Value,
    /// The bytes.
    pub blobs: Vec<Vec<u8>>,
}

impl Parcel {
    /// Data alone.
    pub fn of(json: Value) -> Self {
        Self { json, blobs: Vec::new() }
    }

    fn read(bytes: &[u8]) -> Option<Self> {
        let (length, rest) = bytes.split_first_chunk()?;
        let (text, mut rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        let json: Value = serde_json::from_slice(text).ok()?;
        let mut blobs = Vec::new();
        for length in json["blobs"].as_array().into_iter().flatten() {
            let blob;
            (blob, rest) = rest.split_at_checked(length.as_u64()? as usize)?;
            blobs.push(blob.to_vec());
        }
        Some(Self { json, blobs })
    }

    fn written(mut self) -> Vec<u8> {
        self.json["blobs"] = json!(self.blobs.iter().map(Vec::len).collect::<Vec<_>>());
        let text = self.json.to_string();
        let length = 4 + text.len() + self.blobs.iter().map(Vec::len).sum::<usize>();
        let mut bytes = Vec::with_capacity(4 + length);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
        self.blobs.iter().for_each(|blob| bytes.extend(blob));
        bytes
    }
}

thread_local! {
    /// The last request, and then its answer.
    static ROOM: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    /// What earlier compilations found: only what an edit changed is searched again.
    static REMEMBERED: RefCell<Memory> = RefCell::default();
    /// Why the module trapped: a length and a text.
    static TRAPPED: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Memory that most compilations need, taken in one piece: a browser takes longer to grow a memory a thousand times than to compile a scene.
const USUAL: usize = 64 << 20;

/// Room for a request of so many bytes; where it is.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(length: usize) -> *mut u8 {
    static GROWN: Once = Once::new();
    // What is given back stays in the module's memory, for what is allocated next.
    GROWN.call_once(|| drop(black_box(Vec::<u8>::with_capacity(USUAL))));
    ROOM.with_borrow_mut(|room| {
        *room = vec![0; length];
        room.as_mut_ptr()
    })
}

/// Answers the request that was written; where the answer is. It stays there until the next request.
#[unsafe(no_mangle)]
pub extern "C" fn run() -> *const u8 {
    std::panic::set_hook(Box::new(|fault| {
        let words = fault.to_string();
        TRAPPED.set([&(words.len() as u32).to_le_bytes(), words.as_bytes()].concat());
    }));
    let asked = Parcel::read(&ROOM.take());
    let answer = match asked {
        Some(asked) if asked.json["fresh"] == true => answer(&asked, &mut Memory::default()),
        Some(asked) => REMEMBERED.with_borrow_mut(|memory| answer(&asked, memory)),
        None => Parcel::of(json!({ "error": "the request can't be read" })),
    };
    ROOM.with_borrow_mut(|room| {
        *room = answer.written();
        room.as_ptr()
    })
}

/// Why the module trapped, as a length and a text; zero where nothing is known.
#[unsafe(no_mangle)]
pub extern "C" fn trapped() -> *const u8 {
    TRAPPED.with_borrow(|words| if words.is_empty() { std::ptr::null() } else { words.as_ptr() })
}
