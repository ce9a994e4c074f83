//! Names of columns in the first line of a table: of a workbook, or of text with separators.

use plcc_literal::distance::nearest;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Name,
    Type,
    Address,
    Value,
    Comment,
    /// Whether clients may access a tag, and whether they may write it.
    Accessible,
    Writable,
    /// A column that plcc does not need.
    Other,
}

/// Names of columns, as the TIA Portal, STEP 7 and spreadsheets write them in English and German; without blanks, in small letters.
const NAMES: &[(Kind, &[&str])] = &[
    (Kind::Name, &["name", "symbol", "symbolname", "tag", "tagname"]),
    (Kind::Type, &["datatype", "type", "datentyp", "typ"]),
    (Kind::Address, &["logicaladdress", "address", "logischeadresse", "adresse"]),
    (Kind::Value, &["value", "wert"]),
    (Kind::Comment, &["comment", "kommentar"]),
    (Kind::Accessible, &["hmiaccessible"]),
    (Kind::Writable, &["hmiwriteable"]),
    (Kind::Other, &["path", "pfad", "hmivisible", "retain", "remanenz"]),
];

/// The columns of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    pub name: usize,
    pub ty: Option<usize>,
    /// The address of a tag.
    pub address: Option<usize>,
    /// The value of a constant.
    pub value: Option<usize>,
    pub comment: Option<usize>,
    /// Whether clients may access a tag, and whether they may write it.
    pub accessible: Option<usize>,
    pub writable: Option<usize>,
    /// Misspelt names: their columns, and what is meant.
    pub misspelt: Vec<(usize, &'static str)>,
}

/// Columns beyond these hold no tags.
const COLUMNS_MAX: usize = 64;

/// The columns that the cells of a first line name; `None`: the line names no columns.
pub fn read<'c>(cells: impl Iterator<Item = &'c str>) -> Option<Columns> {
    let kinds: Vec<(Kind, Option<&'static str>)> = cells.take(COLUMNS_MAX).map(kind).collect();
    let column = |wanted: Kind| {
        let exact = kinds.iter().position(|kind| *kind == (wanted, None));
        exact.or_else(|| kinds.iter().position(|(kind, _)| *kind == wanted))
    };
    let known = kinds.iter().filter(|(kind, meant)| meant.is_none() && *kind != Kind::Other).count();
    let columns = Columns {
        name: column(Kind::Name)?,
        ty: column(Kind::Type),
        address: column(Kind::Address),
        value: column(Kind::Value),
        comment: column(Kind::Comment),
        accessible: column(Kind::Accessible),
        writable: column(Kind::Writable),
        misspelt: Vec::new(),
    };
    let used = [
        Some(columns.name),
        columns.ty,
        columns.address,
        columns.value,
        columns.comment,
        columns.accessible,
        columns.writable,
    ];
    let misspelt = kinds.iter().enumerate().filter(|(at, _)| used.contains(&Some(*at)));
    let misspelt = misspelt.filter_map(|(at, (_, meant))| meant.map(|meant| (at, meant))).collect();
    // One or two known names may be in the first line of any text.
    let found = used.iter().flatten().count();
    let is_header = (known >= 2 || known == 1 && found >= 3) && (columns.address.is_some() || columns.value.is_some());
    is_header.then_some(Columns { misspelt, ..columns })
}

/// What a cell of the first line names; of a misspelt name also the right one.
fn kind(cell: &str) -> (Kind, Option<&'static str>) {
    let folded: String = cell.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let of = |name: &str| NAMES.iter().find(|(_, names)| names.contains(&name)).map(|(kind, _)| *kind);
    if let Some(kind) = of(&folded) {
        return (kind, None);
    }
    let meant = nearest(&folded, NAMES.iter().flat_map(|(_, names)| names.iter().copied()));
    match meant.and_then(|meant| Some((of(meant)?, written(meant)))) {
        Some((kind, written)) if kind != Kind::Other => (kind, Some(written)),
        _ => (Kind::Other, None),
    }
}

/// A name of a column as people write it.
fn written(folded: &'static str) -> &'static str {
    match folded {
        "name" => "Name",
        "symbol" => "Symbol",
        "symbolname" => "Symbol name",
        "tag" => "Tag",
        "tagname" => "Tag name",
        "datatype" => "Data Type",
        "type" => "Type",
        "datentyp" => "Datentyp",
        "typ" => "Typ",
        "logicaladdress" => "Logical Address",
        "address" => "Address",
        "logischeadresse" => "Logische Adresse",
        "adresse" => "Adresse",
        "value" => "Value",
        "wert" => "Wert",
        "comment" => "Comment",
        "kommentar" => "Kommentar",
        "hmiaccessible" => "Hmi Accessible",
        "hmiwriteable" => "Hmi Writeable",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_columns() {
        let of = |line: &str| read(line.split(';'));
        let tags = of("Name;Path;Data Type;Logical Address;Comment").expect("tags of the TIA Portal");
        assert_eq!((tags.name, tags.ty, tags.address, tags.comment), (0, Some(2), Some(3), Some(4)));
        assert_eq!(of("Adresse;Symbol;Datentyp").map(|columns| (columns.name, columns.address)), Some((1, Some(0))));
        let misspelt = of("Nmae;Data Type;Logical Adress").expect("two slips, and one name that is right");
        assert_eq!(misspelt.misspelt, [(0, "Name"), (2, "Logical Address")]);
        for line in ["Lamp;Q 4.0;BOOL", "Name;Phone", "Symbol", "Item;Price;Type", ""] {
            assert_eq!(of(line), None, "{line}");
        }
    }
}
