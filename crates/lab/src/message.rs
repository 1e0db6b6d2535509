//! Messages between the page and the engine: JSON with planes of bytes beside it.
//!
//! | bytes, little-endian | |
//! |---|---|
//! | 4 | length of the JSON |
//! | | the JSON, in UTF-8, and zero bytes up to a multiple of 4 |
//! | 4 | number of planes |
//! | 4 each | length of a plane, then its bytes, and zero bytes up to a multiple of 4 |

/// JSON and planes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Message {
    /// Its text.
    pub json: String,
    /// Bytes that need no text: pixels, files.
    pub planes: Vec<Vec<u8>>,
}

impl Message {
    /// The bytes of a message.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        add_part(&mut bytes, self.json.as_bytes());
        bytes.extend((self.planes.len() as u32).to_le_bytes());
        self.planes.iter().for_each(|plane| add_part(&mut bytes, plane));
        bytes
    }

    /// The message of these bytes; `None` if they are none.
    pub fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let json = String::from_utf8(take_part(&mut bytes)?.to_vec()).ok()?;
        let count = take_number(&mut bytes)?;
        let mut planes = Vec::new();
        for _ in 0..count {
            planes.push(take_part(&mut bytes)?.to_vec());
        }
        Some(Self { json, planes })
    }
}

/// Adds a length, as many bytes, and what fills them up.
fn add_part(bytes: &mut Vec<u8>, part: &[u8]) {
    bytes.extend((part.len() as u32).to_le_bytes());
    bytes.extend(part);
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

fn take_number(bytes: &mut &[u8]) -> Option<u32> {
    let (number, rest) = bytes.split_first_chunk::<4>()?;
    *bytes = rest;
    Some(u32::from_le_bytes(*number))
}

/// Takes a length, as many bytes, and what fills them up.
fn take_part<'b>(bytes: &mut &'b [u8]) -> Option<&'b [u8]> {
    let length = take_number(bytes)? as usize;
    let (part, rest) = bytes.split_at_checked(length)?;
    *bytes = rest.get(length.next_multiple_of(4) - length..)?;
    Some(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_come_back() {
        for planes in [vec![], vec![vec![]], vec![vec![1], vec![2, 3, 4, 5], vec![6; 7]]] {
            let message = Message { json: "{\"a\": \"é\"}".to_owned(), planes };
            let bytes = message.to_bytes();
            assert_eq!(bytes.len() % 4, 0);
            assert_eq!(Message::from_bytes(&bytes), Some(message));
            assert_eq!(Message::from_bytes(&bytes[..bytes.len() - 1]), None);
        }
        assert_eq!(Message::from_bytes(&[255; 4]), None);
    }
}
