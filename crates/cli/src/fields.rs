//! Values with several parts as users type them: `key=value,key=value`.
//!
//! Keys are the same in upper and lower case. Values may hold commas: a piece without `=` belongs
//! to the field before it.

/// The fields that have not been used yet.
pub(crate) struct Fields<'a>(Vec<(&'a str, String)>);

impl<'a> Fields<'a> {
    /// Cuts `a=1,2,b=3` at the commas before a key.
    pub(crate) fn split(text: &'a str) -> Result<Self, String> {
        let mut fields: Vec<(&str, String)> = Vec::new();
        for piece in text.split(',').filter(|piece| !piece.is_empty()) {
            let pair = piece.split_once('=');
            if let Some((key, _)) =
                pair.filter(|(key, _)| fields.iter().any(|f| f.0.eq_ignore_ascii_case(key)))
            {
                return Err(format!("`{key}` is given twice"));
            }
            match (pair, fields.last_mut()) {
                (Some((key, value)), _) => fields.push((key, value.to_owned())),
                (None, Some((_, value))) => {
                    value.push(',');
                    value.push_str(piece);
                }
                (None, None) => return Err(format!("`{piece}` has no key: key=value is required")),
            }
        }
        Ok(Self(fields))
    }

    /// Takes a field out and reads it.
    pub(crate) fn take<T>(
        &mut self,
        key: &str,
        read: impl Fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, String> {
        let Some(index) = self.0.iter().position(|f| f.0.eq_ignore_ascii_case(key)) else {
            return Ok(None);
        };
        let (_, value) = self.0.swap_remove(index);
        read(&value).map(Some).map_err(|why| format!("{key}: {why}"))
    }

    /// Whether this field is there.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.0.iter().any(|f| f.0.eq_ignore_ascii_case(key))
    }

    /// The key of a field that was not used, if there is one.
    pub(crate) fn unused(&self) -> Option<&'a str> {
        self.0.first().map(|f| f.0)
    }
}
