//! Accesses as text of SCL or STL: `#motor.speed[#i]`, `"tag"`, `%MW10`, `T#5s`.

use roxmltree::Node;

use crate::xml::{child, children, elements, is, text_of};

/// Which language the text is for: they write addresses and status bits each in their way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    Scl,
    Stl,
}

/// What of an access plcc cannot read: the node, and in words.
pub struct Unreadable<'a, 'i> {
    pub node: Node<'a, 'i>,
    pub what: String,
}

type Text<'a, 'i> = Result<String, Unreadable<'a, 'i>>;

/// How deep accesses may stand in one another, as indices.
const DEPTH_MAX: usize = 32;

/// Text of an `Access`.
pub fn access<'a, 'i>(node: Node<'a, 'i>, notation: Notation) -> Text<'a, 'i> {
    access_at_depth(node, notation, 0)
}

fn access_at_depth<'a, 'i>(node: Node<'a, 'i>, notation: Notation, depth: usize) -> Text<'a, 'i> {
    if depth > DEPTH_MAX {
        return refuse(node, "indices that stand too deep in one another");
    }
    let scope = node.attribute("Scope").unwrap_or_default();
    let mut text = String::new();
    for part in elements(node) {
        match part.tag_name().name() {
            "Symbol" => text.push_str(&symbol(part, scope, notation, depth)?),
            "Constant" => text.push_str(&constant(part, scope)),
            "Address" => text.push_str(&address(part, notation)?),
            "Label" => text.push_str(part.attribute("Name").unwrap_or_default()),
            "Statusword" | "StatusWord" => text.push_str(&status(part)),
            "PredefinedVariable" => text.push_str(part.attribute("Name").unwrap_or_default()),
            "DataType" => text.push_str(&quoted(text_of(part).trim_matches('"'))),
            "Indirect" => text.push_str(&indirect(part, notation, depth)?),
            "AbsoluteOffset" | "Comment" | "LineComment" | "Blank" | "NewLine" | "IntegerAttribute"
            | "StringAttribute" | "BooleanAttribute" => {}
            other => return refuse(part, &format!("an operand with `{other}`")),
        }
    }
    if text.is_empty() { refuse(node, "an operand without a name") } else { Ok(text) }
}

fn refuse<'a, 'i>(node: Node<'a, 'i>, what: &str) -> Text<'a, 'i> {
    Err(Unreadable { node, what: what.to_string() })
}

/// Components of a `Symbol`.
fn symbol<'a, 'i>(node: Node<'a, 'i>, scope: &str, notation: Notation, depth: usize) -> Text<'a, 'i> {
    let mut text = path(node, scope.starts_with("Local"), notation, depth)?;
    for address in children(node, "Address") {
        if !is_informative(address) {
            text.push('.');
            text.push_str(&self::address(address, notation)?);
        }
    }
    Ok(text)
}

/// `#a.b`, `"db".b`: the components below a `Symbol` or an `Instance`.
pub fn path<'a, 'i>(node: Node<'a, 'i>, local: bool, notation: Notation, depth: usize) -> Text<'a, 'i> {
    let mut text = String::new();
    let mut peripheral = false;
    for part in elements(node) {
        match part.tag_name().name() {
            "Component" => {
                let name = part.attribute("Name").unwrap_or_default();
                match (text.is_empty(), local) {
                    (true, true) => text.push_str(&format!("#{}", plain_or_quoted(name))),
                    (true, false) => text.push_str(&quoted(name)),
                    (false, _) => text.push_str(&format!(".{}", plain_or_quoted(name))),
                }
                text.push_str(&behind_component(part, notation, depth)?);
                peripheral |= part.attribute("SimpleAccessModifier").is_some_and(|value| value == "Periphery");
            }
            "Address" | "Token" | "Blank" | "NewLine" | "Comment" | "LineComment" | "BooleanAttribute"
            | "StringAttribute" | "IntegerAttribute" | "Section" => {}
            other => return refuse(part, &format!("an operand with `{other}`")),
        }
    }
    if peripheral {
        text.push_str(":P");
    }
    Ok(text)
}

/// What follows the name of a component: indices, `^`, a slice.
fn behind_component<'a, 'i>(node: Node<'a, 'i>, notation: Notation, depth: usize) -> Text<'a, 'i> {
    let mut text = String::new();
    let modifier = node.attribute("AccessModifier").unwrap_or_default();
    if modifier.starts_with("Reference") {
        text.push('^');
    }
    let brackets = elements(node).any(|part| part.attribute("Text") == Some("["));
    let mut indices = 0;
    for part in elements(node) {
        match part.tag_name().name() {
            "Access" => {
                if !brackets {
                    text.push(if indices == 0 { '[' } else { ',' });
                }
                indices += 1;
                text.push_str(&access_at_depth(part, notation, depth + 1)?);
            }
            // SCL: an index may be an expression.
            "Token" => {
                let token = part.attribute("Text").unwrap_or_default();
                let word = token.chars().all(char::is_alphanumeric);
                text.push_str(&if word { format!(" {token} ") } else { token.to_string() });
            }
            "Blank" | "NewLine" | "Comment" | "LineComment" | "BooleanAttribute" | "StringAttribute"
            | "IntegerAttribute" => {}
            other => return refuse(part, &format!("a component with `{other}`")),
        }
    }
    if indices > 0 && !brackets {
        text.push(']');
    }
    if let Some(slice) = node.attribute("SliceAccessModifier").filter(|slice| *slice != "undef" && !slice.is_empty()) {
        text.push_str(&format!(".%{}", slice.to_uppercase()));
    }
    Ok(text)
}

/// A constant by its name, or its value as written.
fn constant(node: Node, scope: &str) -> String {
    if let Some(name) = node.attribute("Name") {
        return if scope.starts_with("Local") { format!("#{}", plain_or_quoted(name)) } else { quoted(name) };
    }
    let value = child(node, "ConstantValue").map(text_of).unwrap_or_default();
    let ty = child(node, "ConstantType").map(text_of).unwrap_or_default();
    let is = |known: &str| ty.eq_ignore_ascii_case(known);
    let whole = || value.strip_prefix('-').unwrap_or(&value).bytes().all(|digit| digit.is_ascii_digit());
    match value.as_str() {
        "" if is("String") || is("WString") => "''".to_string(),
        "1" if is("Bool") => "TRUE".to_string(),
        "0" if is("Bool") => "FALSE".to_string(),
        // A REAL that is written like a whole number.
        _ if (is("Real") || is("LReal")) && !value.is_empty() && whole() => format!("{value}.0"),
        _ => value.replace(['\n', '\r'], " "),
    }
}

/// `BR`, `OV`, `>0`, `STW`.
fn status(node: Node) -> String {
    let name = node.attribute("Combination").or_else(|| node.attribute("Name")).unwrap_or_default();
    let known = match name {
        "EQ" | "Equal" => "==0",
        "NE" | "NotEqual" => "<>0",
        "GT" | "Greater" => ">0",
        "LT" | "Less" => "<0",
        "GE" | "GreaterOrEqual" => ">=0",
        "LE" | "LessOrEqual" => "<=0",
        other => other,
    };
    known.to_string()
}

/// The letter of a width, by the type of an address: none for a bit.
fn width_letter(ty: &str) -> &'static str {
    let is = |known: &[&str]| known.iter().any(|known| known.eq_ignore_ascii_case(ty));
    match () {
        () if is(&["Bool"]) => "X",
        () if is(&["Byte", "SInt", "USInt", "Char"]) => "B",
        () if is(&["Word", "Int", "UInt", "S5Time", "Date", "WChar"]) => "W",
        () if is(&["LWord", "LInt", "ULInt", "LReal", "LTime", "LTime_Of_Day", "LDT", "DTL", "Date_And_Time"]) => "L",
        () => "D",
    }
}

fn is_informative(node: Node) -> bool {
    node.attribute("Informative").is_some_and(|value| value.eq_ignore_ascii_case("true") || value == "1")
}

/// Letters of an area, and whether it is accessed past the process image.
fn area_letters(area: &str, notation: Notation) -> Option<(&'static str, bool)> {
    Some(match (area, notation) {
        ("Input", _) => ("I", false),
        ("Output", _) => ("Q", false),
        ("Memory", _) => ("M", false),
        ("PeripheryInput", Notation::Scl) => ("I", true),
        ("PeripheryOutput", Notation::Scl) => ("Q", true),
        ("PeripheryInput", Notation::Stl) => ("PI", false),
        ("PeripheryOutput", Notation::Stl) => ("PQ", false),
        ("Local" | "LocalC" | "LocalN", _) => ("L", false),
        ("DB", _) => ("DB", false),
        ("DI", _) => ("DI", false),
        ("Timer", _) => ("T", false),
        ("Counter", _) => ("C", false),
        ("FB", _) => ("FB", false),
        ("FC", _) => ("FC", false),
        _ => return None,
    })
}

/// `%I0.0`, `%DB1.DBW4`, `T5`, and of a symbol's address what stands behind the point: `%DBX0.0`.
fn address<'a, 'i>(node: Node<'a, 'i>, notation: Notation) -> Text<'a, 'i> {
    let area = node.attribute("Area").unwrap_or_default();
    let ty = node.attribute("Type").unwrap_or_default();
    let number = |name: &str| node.attribute(name).and_then(|value| value.trim().parse::<u32>().ok());
    let (block, offset) = (number("BlockNumber"), number("BitOffset"));
    let width = width_letter(ty);
    let place = |prefix: &str, width: &str| {
        let offset = offset.unwrap_or(0);
        if width == "X" || width.is_empty() {
            format!("{prefix}{width}{}.{}", offset / 8, offset % 8)
        } else {
            format!("{prefix}{width}{}", offset / 8)
        }
    };
    let sign = if notation == Notation::Scl { "%" } else { "" };
    if area == "None" {
        return Ok(format!("{sign}{}", place("DB", width)));
    }
    let Some((letters, peripheral)) = area_letters(area, notation) else {
        return refuse(node, &format!("the area `{area}`"));
    };
    Ok(match letters {
        "T" | "C" => format!("{sign}{letters}{}", block.filter(|block| *block > 0).or(offset).unwrap_or(0)),
        "FB" | "FC" => format!("{letters}{}", block.unwrap_or(0)),
        "DB" | "DI" => {
            let whole = ty.is_empty() || ty.starts_with("Block") || ty == "DB_ANY" || offset.is_none();
            match block {
                Some(block) if whole => format!("{sign}{letters}{block}"),
                Some(block) if block > 0 && letters == "DB" => format!("{sign}DB{block}.{}", place("DB", width)),
                _ => format!("{sign}{}", place(letters, width)),
            }
        }
        letters => {
            let suffix = if peripheral { ":P" } else { "" };
            let width = if width == "X" { "" } else { width };
            format!("{sign}{}{suffix}", place(letters, width))
        }
    })
}

/// STL: `MW [AR1,P#2.0]`, `DBW [MD 4]`.
fn indirect<'a, 'i>(node: Node<'a, 'i>, notation: Notation, depth: usize) -> Text<'a, 'i> {
    if notation != Notation::Stl {
        return refuse(node, "an indirect address");
    }
    let width = match node.attribute("Width").unwrap_or_default() {
        "Bit" | "Bool" | "X" => "X",
        "Byte" | "B" => "B",
        "Word" | "W" => "W",
        "None" | "" => "",
        _ => "D",
    };
    let area = node.attribute("Area").unwrap_or_default();
    let letters = area_letters(area, notation).map_or("", |(letters, _)| letters);
    let width = if width == "X" && !letters.is_empty() && !letters.starts_with('D') { "" } else { width };
    let register = node.attribute("Register").filter(|register| !register.is_empty() && *register != "None");
    let offset = node.attribute("BitOffset").and_then(|offset| offset.trim().parse::<u32>().ok()).unwrap_or(0);
    match (register, child(node, "Access")) {
        (Some(register), _) => Ok(format!("{letters}{width} [{register},P#{}.{}]", offset / 8, offset % 8)),
        (None, Some(pointer)) => Ok(format!("{letters}{width} [{}]", access_at_depth(pointer, notation, depth + 1)?)),
        (None, None) => refuse(node, "an indirect address without its pointer"),
    }
}

/// The name in quotes; signs that no name can hold are left out.
pub fn quoted(name: &str) -> String {
    let name: String = name.chars().filter(|c| *c != '"').map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("\"{name}\"")
}

/// The name as a word of SCL and STL, else in quotes.
pub fn plain_or_quoted(name: &str) -> String {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let plain = name.starts_with(letter) && name.chars().all(|c| letter(c) || c.is_ascii_digit());
    if plain { name.to_string() } else { quoted(name) }
}

/// Where the text of an access stands best: over the name of its first component.
pub fn wanted_place(node: Node) -> usize {
    let named =
        |part: &Node| part.attribute_node("Name").map(|name| (name.range_value().start, name.value().to_string()));
    let found = node.descendants().find(|part| is(*part, "Component") || is(*part, "Constant"));
    let Some((start, name)) = found.as_ref().and_then(named) else {
        let value = node.descendants().find(|part| is(*part, "ConstantValue"));
        return value.and_then(|value| value.first_child()).map_or(node.range().start, |text| text.range().start);
    };
    start.saturating_sub(if plain_or_quoted(&name).starts_with('"') { 2 } else { 1 })
}
