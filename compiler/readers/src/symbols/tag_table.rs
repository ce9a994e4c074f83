//! Tag tables of the TIA Portal in XML: exports (`SW.Tags.PlcTagTable`, of V13 `SW.ControllerTagTable`) with their tags and constants,
//! and what the editor writes (`Tagtable`).
//!
//! Source: LAD/FBD reference A.10.

use crate::spelling::{self, Grammar, Names, Parts};
use crate::xml::{self, child, elements, head, text_of};
use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_syntax::scl::fragment;
use roxmltree::Node;

use super::{
    GlobalConstant, Symbol, SymbolTable, UnreadableRow, address_fault, external, meant_address, parse_address,
};

/// Reads the tag tables of an export.
pub fn parse(file: FileId, text: &str) -> (SymbolTable, Vec<Diagnostic>) {
    let mut table = SymbolTable::default();
    let mut diagnostics = Vec::new();
    match xml::parse(text) {
        Ok(document) => {
            let root = document.root_element();
            let misspelt = spelling::faults(file, &document, &GRAMMAR);
            if !misspelt.is_empty() {
                return (SymbolTable::default(), misspelt);
            }
            let mut reader = Reader { file, text, table: &mut table, diagnostics: &mut diagnostics };
            if xml::is_tag_table(root.tag_name().name()) {
                reader.editor(root);
            }
            let objects = xml::objects(root);
            objects
                .into_iter()
                .filter(|object| xml::is_exported_tags(object.tag_name().name()))
                .for_each(|table| reader.table(table));
        }
        Err(error) => diagnostics.push(xml::broken(file, text, &error)),
    }
    (table, diagnostics)
}

/// How the elements of tag tables are spelt. Those of blocks in the same file have their own reader.
const GRAMMAR: Grammar = Grammar { format: "a tag table of the TIA Portal", parts, everywhere: Names::Words("") };

fn parts(node: Node) -> Option<Parts> {
    let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
    let children = match node.tag_name().name() {
        name if xml::is_block(name) => return None,
        name if is_part(name) => "AttributeList LinkList ObjectList",
        "ObjectList" if parent == "SW.Tags.PlcTagTable" => {
            "SW.Tags.PlcTag SW.Tags.PlcUserConstant SW.Tags.PlcSystemConstant MultilingualText"
        }
        "ObjectList" if parent == "SW.ControllerTagTable" => {
            "SW.ControllerTag SW.ControllerUserConstant SW.ControllerSystemConstant MultilingualText"
        }
        "AttributeList" if matches!(parent, "SW.Tags.PlcTag" | "SW.ControllerTag") => {
            "DataTypeName LogicalAddress Name ExternalAccessible ExternalVisible ExternalWritable"
        }
        "AttributeList" if is_part(parent) => "DataTypeName Name Value",
        _ => "",
    };
    Some(Parts { attributes: Names::Words(""), children: Names::Words(children) })
}

/// Whether an element of that name is a table, a tag or a constant of an export.
fn is_part(name: &str) -> bool {
    name.starts_with("SW.Tags.") || name.starts_with("SW.Controller")
}

struct Reader<'a> {
    file: FileId,
    text: &'a str,
    table: &'a mut SymbolTable,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Reader<'_> {
    fn table(&mut self, table: Node) {
        for row in child(table, "ObjectList").into_iter().flat_map(elements) {
            match row.tag_name().name() {
                "SW.Tags.PlcTag" | "SW.ControllerTag" => self.tag(row),
                "SW.Tags.PlcUserConstant" | "SW.ControllerUserConstant" => self.constant(row),
                // Numbers of hardware; the station defines those of fast counters and pulse generators.
                "SW.Tags.PlcSystemConstant" | "SW.ControllerSystemConstant" if !self.is_of_station(row) => {
                    self.constant(row);
                }
                "SW.Tags.PlcSystemConstant" | "SW.ControllerSystemConstant" | "MultilingualText" => {}
                other => {
                    let span = Span::new(self.file, head(row));
                    self.bad(span, format!("`{other}` is neither a tag nor a constant"));
                }
            }
        }
    }

    /// Whether plc.toml and the runtime define the number of a constant of the system.
    fn is_of_station(&self, row: Node) -> bool {
        let name = self.row(row).name.to_ascii_lowercase();
        ["local~hsc_", "local~pulse_", "ob_"].iter().any(|prefix| name.starts_with(prefix))
    }

    /// `<Tagtable><Tag type='Bool' addr='%I0.0' remark='text'>Start</Tag><Constant type='Int' value='5'>Max</Constant></Tagtable>`
    fn editor(&mut self, table: Node) {
        for row in elements(table) {
            let kind = row.tag_name().name();
            let attribute = |names: &[&str]| {
                let mut found = names.iter().filter_map(|name| row.attribute(*name));
                found.next().unwrap_or_default().trim().to_string()
            };
            let name = match text_of(row) {
                text if text.is_empty() => attribute(&["name", "Name"]),
                text => text,
            };
            let span = self.span_of(Some(row), row);
            let ty = attribute(&["type", "Type"]).trim_matches('"').to_string();
            if xml::is_tag_table(kind) {
                self.editor(row);
            } else if name.is_empty() {
                self.bad(Span::new(self.file, head(row)), format!("`{kind}` without a name"));
            } else if kind.eq_ignore_ascii_case("Tag") {
                let address = attribute(&["addr", "Addr", "address"]);
                match parse_address(address.trim_end_matches(":P")) {
                    _ if address.is_empty() => {
                        self.table.unreadable.push(UnreadableRow::without_address(name, span));
                    }
                    Some(target) => {
                        let comment = attribute(&["remark", "comment"]);
                        let external = external(row.attribute("hmiAccessible"), row.attribute("hmiWriteable"));
                        self.table.symbols.push(Symbol { name, target, ty, comment, external, span });
                    }
                    None => self.bad_address(span, name, &address),
                }
            } else if kind.eq_ignore_ascii_case("Constant") {
                let Some(value) = row.attribute_node("value").or_else(|| row.attribute_node("Value")) else {
                    self.bad(span, format!("the constant `{name}` has no value"));
                    continue;
                };
                self.value(name, ty, span, value.range_value(), value.value());
            } else {
                self.bad(span, format!("`{kind}` is neither a tag nor a constant"));
            }
        }
    }

    fn span_of(&self, node: Option<Node>, row: Node) -> Span {
        let text = node.and_then(|node| node.first_child());
        Span::new(self.file, text.map_or_else(|| head(row), |text| text.range()))
    }

    fn bad(&mut self, span: Span, why: String) {
        let message = Diagnostic::new(Code::SymbolTable, span, "this tag cannot be read").label(why);
        self.diagnostics.push(message.help("a tag has a name, a data type and an address such as `%I0.0`"));
    }

    fn bad_address(&mut self, span: Span, name: String, address: &str) {
        let reason = address_fault(address);
        let meant = meant_address(address);
        self.table.unreadable.push(UnreadableRow { name, reason: reason.clone(), meant, span });
        self.bad(span, reason);
    }

    fn tag(&mut self, row: Node) {
        let Row { name, ty, span } = self.row(row);
        let address_node = setting(row, "LogicalAddress");
        let address = address_node.map(text_of).unwrap_or_default();
        if name.is_empty() {
            return self.bad(Span::new(self.file, head(row)), "a tag without a name".to_string());
        }
        if address.is_empty() {
            return self.table.unreadable.push(UnreadableRow::without_address(name, span));
        }
        // `%IW64:P` of hardware: the tag is the process image, its access says `:P` itself.
        let bare = address.trim_end_matches(":P");
        let Some(target) = parse_address(bare) else {
            let span = self.span_of(address_node, row);
            return self.bad_address(span, name, bare);
        };
        let comment = row.descendants().find(|node| xml::is(*node, "Text")).map(text_of).unwrap_or_default();
        let [accessible, writable] =
            ["ExternalAccessible", "ExternalWritable"].map(|name| setting(row, name).map(text_of));
        let external = external(accessible.as_deref(), writable.as_deref());
        self.table.symbols.push(Symbol { name, target, ty, comment, external, span });
    }

    fn constant(&mut self, row: Node) {
        let Row { name, ty, span } = self.row(row);
        if name.is_empty() {
            return self.bad(Span::new(self.file, head(row)), "a constant without a name".to_string());
        }
        match setting(row, "Value").and_then(|value| value.first_child()) {
            Some(text) => self.value(name, ty, span, text.range(), text.text().unwrap_or_default()),
            None => self.bad(span, format!("the constant `{name}` has no value")),
        }
    }

    /// A constant whose value is at a position in the file.
    fn value(&mut self, name: String, ty: String, span: Span, range: std::ops::Range<usize>, value: &str) {
        // A value with escaped characters is shorter than its text in the file.
        let own = self.text.get(range.clone()) == Some(value);
        let padded = if own { String::new() } else { " ".repeat(range.start) + value };
        let source = if own { self.text } else { &padded };
        let (expr, messages) = fragment::expression(self.file, source, range.start..range.start + value.len());
        self.diagnostics.extend(messages);
        self.table.constants.push(GlobalConstant { name, ty, value: expr, span });
    }

    fn row(&self, row: Node) -> Row {
        let name = setting(row, "Name");
        Row {
            span: self.span_of(name, row),
            name: name.map(text_of).unwrap_or_default(),
            ty: setting(row, "DataTypeName").map(text_of).unwrap_or_default().trim_matches('"').to_string(),
        }
    }
}

/// The common parts of tags and constants.
struct Row {
    name: String,
    ty: String,
    span: Span,
}

/// A setting of a row: in its attributes, or as a link with a name (`DataType` of old exports).
fn setting<'a, 'i>(row: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    if let Some(found) = child(row, "AttributeList").and_then(|list| child(list, name)) {
        return Some(found);
    }
    let link = child(row, "LinkList").and_then(|list| child(list, name.trim_end_matches("Name")))?;
    child(link, "Name")
}

#[cfg(test)]
mod damage {
    use super::*;

    /// The messages for a table with these rows.
    fn told(rows: &str) -> Vec<String> {
        let text = format!(
            "\u{feff}<Document><SW.Tags.PlcTagTable><ObjectList>{rows}</ObjectList></SW.Tags.PlcTagTable></Document>"
        );
        let (_, messages) = parse(FileId(0), &text);
        messages.into_iter().map(|message| message.primary.text).collect()
    }

    #[test]
    fn rows_without_a_name_or_a_value_are_told() {
        let none: [&str; 0] = [];
        let tag = "<SW.Tags.PlcTag><AttributeList><DataTypeName>Bool</DataTypeName><LogicalAddress>%I0.0</LogicalAddress><Name>A</Name></AttributeList></SW.Tags.PlcTag>";
        assert_eq!(told(tag), none);
        assert_eq!(told(&tag.replace("<Name>A</Name>", "<Name />")), ["a tag without a name"]);
        assert_eq!(told(&tag.replace("<Name>A</Name>", "")), ["a tag without a name"]);
        assert_eq!(told("<SW.Tags.PlcTag/>"), ["a tag without a name"]);
        assert_eq!(told(&tag.replace("<LogicalAddress>%I0.0</LogicalAddress>", "")), none, "never typed in");
        assert_eq!(told(&tag.replace("%I0.0", "%I0.9")), ["a byte has the bits 0 to 7, not 9"]);
        let constant = "<SW.Tags.PlcUserConstant><AttributeList><DataTypeName>Int</DataTypeName><Name>K</Name><Value>1</Value></AttributeList></SW.Tags.PlcUserConstant>";
        assert_eq!(told(constant), none);
        assert_eq!(told(&constant.replace("<Value>1</Value>", "<Value/>")), ["the constant `K` has no value"]);
        assert_eq!(told(&constant.replace("<Name>K</Name>", "")), ["a constant without a name"]);
    }
}

#[cfg(test)]
mod tests {
    use plcc_diag::SourceFile;
    use plcc_syntax::ast::{Area, Width};
    use plcc_syntax::scl::text;

    use super::super::{External, SymbolTarget};

    const TABLE: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<Document><Engineering version="V17" /><SW.Tags.PlcTagTable ID="0"><AttributeList><Name>Default tag table</Name></AttributeList><ObjectList>
<SW.Tags.PlcTag ID="1" CompositionName="Tags"><AttributeList><DataTypeName>Bool</DataTypeName><LogicalAddress>%Q4.1</LogicalAddress><Name>Лампа 1/2</Name></AttributeList>
<ObjectList><MultilingualText ID="2" CompositionName="Comment"><ObjectList><MultilingualTextItem ID="3"><AttributeList><Culture>ru-RU</Culture><Text>зелёная</Text></AttributeList></MultilingualTextItem></ObjectList></MultilingualText></ObjectList></SW.Tags.PlcTag>
<SW.Tags.PlcTag ID="4" CompositionName="Tags"><AttributeList><LogicalAddress>%IW64</LogicalAddress><Name>Level</Name></AttributeList><LinkList><DataType TargetID="@OpenLink"><Name>Int</Name></DataType></LinkList></SW.Tags.PlcTag>
<SW.Tags.PlcTag ID="5" CompositionName="Tags"><AttributeList><DataTypeName>Bool</DataTypeName><LogicalAddress>%X9</LogicalAddress><Name>Bad</Name></AttributeList></SW.Tags.PlcTag>
<SW.Tags.PlcUserConstant ID="6" CompositionName="UserConstants"><AttributeList><DataTypeName>Int</DataTypeName><Name>MAX</Name><Value>12</Value></AttributeList></SW.Tags.PlcUserConstant>
<SW.Tags.PlcUserConstant ID="7" CompositionName="UserConstants"><AttributeList><DataTypeName>String</DataTypeName><Name>SIGN</Name><Value>'&lt;'</Value></AttributeList></SW.Tags.PlcUserConstant>
</ObjectList></SW.Tags.PlcTagTable></Document>"#;

    #[test]
    fn tables_of_the_editor() {
        let text = "<?xml version='1.0' encoding='utf-8'?>\n<Tagtable name='Tags'>\n <Tag type='Bool' hmiVisible='True' retain='False' remark='green' addr='%Q4.1'>Lamp &amp; horn</Tag>\n \
                    <Tag type='Int' addr='%MW10'>Level</Tag>\n <Tag type='Int' addr='%X10'>Bad</Tag>\n <Constant type='Int' remark='' value='12'>MAX</Constant>\n</Tagtable>\n";
        let (table, messages) = super::super::parse(plcc_diag::FileId(0), &SourceFile::new("tags.xml", text));
        let lamp = &table.symbols[0];
        assert_eq!(lamp.target, SymbolTarget::Memory { area: Area::Q, width: Width::Bit, byte: 4, bit: 1 });
        assert_eq!((lamp.name.as_str(), lamp.comment.as_str()), ("Lamp & horn", "green"));
        assert_eq!((table.symbols.len(), table.constants.len(), messages.len()), (2, 1, 1));
        assert_eq!(text::expr(&table.constants[0].value), "12");
    }

    #[test]
    fn tags_say_what_clients_may_do() {
        let tag = |name: &str, byte: u32, settings: &str| {
            format!(
                "<SW.Tags.PlcTag><AttributeList><DataTypeName>Int</DataTypeName>{settings}<LogicalAddress>%MW{byte}</LogicalAddress>\
                 <Name>{name}</Name></AttributeList></SW.Tags.PlcTag>"
            )
        };
        let hidden = "<ExternalAccessible>false</ExternalAccessible><ExternalWritable>false</ExternalWritable>";
        let rows =
            [tag("A", 0, hidden), tag("B", 2, "<ExternalWritable>false</ExternalWritable>"), tag("C", 4, "")].concat();
        let export =
            format!("<Document><SW.Tags.PlcTagTable><ObjectList>{rows}</ObjectList></SW.Tags.PlcTagTable></Document>");
        let editor = "<Tagtable><Tag type='Int' hmiAccessible='False' hmiWriteable='False' addr='%MW0'>A</Tag>\
                      <Tag type='Int' hmiWriteable='False' addr='%MW2'>B</Tag><Tag type='Int' addr='%MW4'>C</Tag></Tagtable>";
        for text in [export.as_str(), editor] {
            let (table, messages) = super::parse(plcc_diag::FileId(0), text);
            assert!(messages.is_empty(), "{messages:#?}");
            let found: Vec<External> = table.symbols.iter().map(|symbol| symbol.external).collect();
            assert_eq!(found, [External::Hidden, External::Read, External::Write], "{text}");
        }
    }

    #[test]
    fn tables_of_v13_have_other_names() {
        let text = TABLE.replace("SW.Tags.PlcTag", "SW.ControllerTag").replace("SW.Tags.Plc", "SW.Controller");
        let (table, messages) = super::super::parse(plcc_diag::FileId(0), &SourceFile::new("tags.xml", text));
        let names: Vec<&str> = table.symbols.iter().map(|symbol| symbol.name.as_str()).collect();
        assert_eq!(names, ["Лампа 1/2", "Level"]);
        assert_eq!((table.constants.len(), messages.len()), (2, 1));
    }

    #[test]
    fn tags_and_constants() {
        let (table, messages) = super::super::parse(plcc_diag::FileId(0), &SourceFile::new("tags.xml", TABLE));
        let lamp = &table.symbols[0];
        assert_eq!(lamp.target, SymbolTarget::Memory { area: Area::Q, width: Width::Bit, byte: 4, bit: 1 });
        assert_eq!((lamp.name.as_str(), lamp.comment.as_str()), ("Лампа 1/2", "зелёная"));
        assert_eq!(&TABLE[lamp.span.range()], "Лампа 1/2");
        assert_eq!((table.symbols[1].name.as_str(), table.symbols[1].ty.as_str()), ("Level", "Int"));
        assert_eq!((table.symbols.len(), messages.len()), (2, 1));
        assert_eq!(&TABLE[messages[0].primary.span.range()], "%X9");
        let constants: Vec<String> =
            table.constants.iter().map(|c| format!("{} {} {}", c.name, c.ty, text::expr(&c.value))).collect();
        assert_eq!(constants, ["MAX Int 12", "SIGN String TEXT#\"<\""]);
    }
}
