//! The blocks of the program, from the document with which the page shows them. See `page/mod.rs` of the crate view.

use std::io::Read;
use std::sync::Arc;

use flate2::read::GzDecoder;
use serde::Deserialize;

use crate::flow::Logic;
use crate::forcing::Symbols;

/// Bytes of a document that are read at most: a damaged one may say that it has any number.
const DOCUMENT_MAX: u64 = 256 << 20;

/// A block.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Page {
    /// `FB 1`; of a block without a number its name.
    pub id: String,
    /// Its symbol, if it has one.
    pub name: String,
    /// `LAD`, `STL` ...; empty for data.
    #[serde(rename = "lang")]
    pub language: String,
    pub title: String,
    /// Its networks, or parts without a number.
    #[serde(rename = "secs")]
    pub sections: Vec<Section>,
    /// The symbols of the program.
    #[serde(skip)]
    pub symbols: Arc<Symbols>,
}

/// A network, or a part of a block that has none.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Section {
    /// 0: it is not a network.
    #[serde(rename = "n")]
    pub number: usize,
    pub title: String,
    /// Labels to which others jump.
    pub labels: Vec<String>,
    /// Its lines, if it is text.
    pub text: Option<String>,
    /// The first byte of each line in the source.
    pub starts: Vec<u32>,
    /// `stl` or `scl`.
    pub kind: String,
    /// Its statements, if they are drawn.
    pub code: Option<Code>,
    /// Its drawing, and how the power flows in it.
    pub svg: Option<String>,
    pub logic: Option<Logic>,
}

/// Lines of a source.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Code {
    pub text: String,
    /// The first byte of each line in the source.
    pub starts: Vec<u32>,
}

impl Page {
    /// As orders name the block: `FB1`.
    pub fn key(&self) -> String {
        self.id.replace(' ', "")
    }

    /// `FB 1 Counting`
    pub fn label(&self) -> String {
        match self.name.is_empty() || self.name == self.id {
            true => self.id.clone(),
            false => format!("{} {}", self.id, self.name),
        }
    }

    /// It has statements, not only data.
    pub fn has_code(&self) -> bool {
        !self.language.is_empty()
    }
}

impl Section {
    /// What it shows as lines while it is watched; `None`: it is a drawing.
    pub fn lines(&self) -> Option<Code> {
        match (&self.code, &self.text) {
            (Some(code), _) => Some(code.clone()),
            (None, Some(text)) => Some(Code { text: text.clone(), starts: self.starts.clone() }),
            (None, None) => None,
        }
    }
}

/// The blocks of a compressed document. `Err`: it is not one.
pub fn pages(compressed: &[u8]) -> Result<Vec<Page>, String> {
    let mut text = String::new();
    let mut bytes = GzDecoder::new(compressed).take(DOCUMENT_MAX);
    bytes.read_to_string(&mut text).map_err(|error| format!("the blocks of the program: {error}"))?;
    pages_of(&text)
}

/// The blocks of a document.
pub fn pages_of(html: &str) -> Result<Vec<Page>, String> {
    #[derive(Deserialize)]
    struct Data {
        pages: Vec<Page>,
        /// Addresses and names.
        #[serde(default)]
        symbols: Vec<(String, String)>,
    }
    let begin = "<script id=\"data\" type=\"application/json\">";
    let data = html.split_once(begin).and_then(|(_, rest)| rest.split_once("</script>"));
    let (data, _) = data.ok_or("the blocks of the program: their document has no data")?;
    let data: Data = serde_json::from_str(data).map_err(|error| format!("the blocks of the program: {error}"))?;
    let symbols: Symbols = data.symbols.into_iter().map(|(address, name)| (name.to_lowercase(), address)).collect();
    let symbols = Arc::new(symbols);
    Ok(data.pages.into_iter().map(|page| Page { symbols: Arc::clone(&symbols), ..page }).collect())
}
