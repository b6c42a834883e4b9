//! tmp
use super::{Diagnostic, source::*};
pub fn format(id: FileId, sources: &Sources) -> Result<String, Vec<Diagnostic>> { Ok(sources.get(id).map_or(String::new(), |s| s.text.clone())) }
