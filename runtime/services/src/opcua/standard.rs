//! Nodes of the standard that every server has: the objects where clients begin, types, references. Source: OPC 10000-5; the
//! numbers are those of NodeIds.csv.

/// Classes of nodes.
pub const OBJECT: u32 = 1;
pub const VARIABLE: u32 = 2;
const OBJECT_TYPE: u32 = 8;
const VARIABLE_TYPE: u32 = 16;
const REFERENCE_TYPE: u32 = 32;
pub const DATA_TYPE: u32 = 64;

/// References.
pub const REFERENCES: u32 = 31;
pub const ORGANIZES: u32 = 35;
pub const HAS_ENCODING: u32 = 38;
pub const HAS_TYPE_DEFINITION: u32 = 40;
pub const HAS_SUBTYPE: u32 = 45;
pub const HAS_PROPERTY: u32 = 46;
pub const HAS_COMPONENT: u32 = 47;

pub const OBJECTS: u32 = 85;
/// The server itself, which has the events.
pub const SERVER: u32 = 2253;
pub const FOLDER_TYPE: u32 = 61;
pub const BASE_OBJECT_TYPE: u32 = 58;
pub const BASE_EVENT_TYPE: u32 = 2041;
pub const SYSTEM_EVENT_TYPE: u32 = 2130;
pub const EVENT_QUEUE_OVERFLOW: u32 = 3035;
pub const DATA_VARIABLE_TYPE: u32 = 63;
pub const PROPERTY_TYPE: u32 = 68;
/// Of a variable with a unit, and of the encoding of a structure.
pub const ANALOG_UNIT_TYPE: u32 = 17_497;
pub const ENCODING_TYPE: u32 = 76;

/// A node: its number, class and name, the node above it with the reference from there, and its type: of an object or variable its
/// type definition, of a variable also the type of its value.
pub struct Row {
    pub id: u32,
    pub class: u32,
    pub name: &'static str,
    pub parent: u32,
    pub reference: u32,
    pub definition: u32,
    pub value: u32,
}

const fn object(id: u32, name: &'static str, parent: u32, reference: u32, definition: u32) -> Row {
    Row { id, class: OBJECT, name, parent, reference, definition, value: 0 }
}

const fn property(id: u32, name: &'static str, parent: u32, value: u32) -> Row {
    Row { id, class: VARIABLE, name, parent, reference: HAS_PROPERTY, definition: PROPERTY_TYPE, value }
}

const fn component(id: u32, name: &'static str, parent: u32, definition: u32, value: u32) -> Row {
    Row { id, class: VARIABLE, name, parent, reference: HAS_COMPONENT, definition, value }
}

const fn ty(class: u32, id: u32, name: &'static str, parent: u32) -> Row {
    Row { id, class, name, parent, reference: HAS_SUBTYPE, definition: 0, value: 0 }
}

const fn root(class: u32, id: u32, name: &'static str, parent: u32) -> Row {
    Row { id, class, name, parent, reference: ORGANIZES, definition: 0, value: 0 }
}

/// All rows, in the order in which they are listed.
pub const ROWS: &[Row] = &[
    object(84, "Root", 0, 0, FOLDER_TYPE),
    object(OBJECTS, "Objects", 84, ORGANIZES, FOLDER_TYPE),
    object(86, "Types", 84, ORGANIZES, FOLDER_TYPE),
    object(87, "Views", 84, ORGANIZES, FOLDER_TYPE),
    object(SERVER, "Server", OBJECTS, ORGANIZES, 2004),
    property(2254, "ServerArray", 2253, 12),
    property(2255, "NamespaceArray", 2253, 12),
    component(2256, "ServerStatus", 2253, 2138, 862),
    component(2257, "StartTime", 2256, DATA_VARIABLE_TYPE, 294),
    component(2258, "CurrentTime", 2256, DATA_VARIABLE_TYPE, 294),
    component(2259, "State", 2256, DATA_VARIABLE_TYPE, 852),
    property(2267, "ServiceLevel", 2253, 3),
    object(2268, "ServerCapabilities", 2253, HAS_COMPONENT, 2013),
    property(2269, "ServerProfileArray", 2268, 12),
    property(2271, "LocaleIdArray", 2268, 295),
    property(2272, "MinSupportedSampleRate", 2268, 290),
    property(2735, "MaxBrowseContinuationPoints", 2268, 5),
    property(11702, "MaxArrayLength", 2268, 7),
    object(11704, "OperationLimits", 2268, HAS_COMPONENT, 11564),
    property(11705, "MaxNodesPerRead", 11704, 7),
    property(11707, "MaxNodesPerWrite", 11704, 7),
    property(11710, "MaxNodesPerBrowse", 11704, 7),
    property(11712, "MaxNodesPerTranslateBrowsePathsToNodeIds", 11704, 7),
    property(11714, "MaxMonitoredItemsPerCall", 11704, 7),
    object(88, "ObjectTypes", 86, ORGANIZES, FOLDER_TYPE),
    object(89, "VariableTypes", 86, ORGANIZES, FOLDER_TYPE),
    object(90, "DataTypes", 86, ORGANIZES, FOLDER_TYPE),
    object(91, "ReferenceTypes", 86, ORGANIZES, FOLDER_TYPE),
    root(OBJECT_TYPE, BASE_OBJECT_TYPE, "BaseObjectType", 88),
    ty(OBJECT_TYPE, FOLDER_TYPE, "FolderType", BASE_OBJECT_TYPE),
    ty(OBJECT_TYPE, 2004, "ServerType", BASE_OBJECT_TYPE),
    ty(OBJECT_TYPE, 2013, "ServerCapabilitiesType", BASE_OBJECT_TYPE),
    ty(OBJECT_TYPE, 11564, "OperationLimitsType", FOLDER_TYPE),
    ty(OBJECT_TYPE, ENCODING_TYPE, "DataTypeEncodingType", BASE_OBJECT_TYPE),
    ty(OBJECT_TYPE, BASE_EVENT_TYPE, "BaseEventType", BASE_OBJECT_TYPE),
    property(2042, "EventId", BASE_EVENT_TYPE, 15),
    property(2043, "EventType", BASE_EVENT_TYPE, 17),
    property(2044, "SourceNode", BASE_EVENT_TYPE, 17),
    property(2045, "SourceName", BASE_EVENT_TYPE, 12),
    property(2046, "Time", BASE_EVENT_TYPE, 294),
    property(2047, "ReceiveTime", BASE_EVENT_TYPE, 294),
    property(2050, "Message", BASE_EVENT_TYPE, 21),
    property(2051, "Severity", BASE_EVENT_TYPE, 5),
    ty(OBJECT_TYPE, SYSTEM_EVENT_TYPE, "SystemEventType", BASE_EVENT_TYPE),
    ty(OBJECT_TYPE, EVENT_QUEUE_OVERFLOW, "EventQueueOverflowEventType", BASE_EVENT_TYPE),
    root(VARIABLE_TYPE, 62, "BaseVariableType", 89),
    ty(VARIABLE_TYPE, DATA_VARIABLE_TYPE, "BaseDataVariableType", 62),
    ty(VARIABLE_TYPE, PROPERTY_TYPE, "PropertyType", 62),
    ty(VARIABLE_TYPE, 2138, "ServerStatusType", DATA_VARIABLE_TYPE),
    ty(VARIABLE_TYPE, 2365, "DataItemType", DATA_VARIABLE_TYPE),
    ty(VARIABLE_TYPE, 15_318, "BaseAnalogType", 2365),
    ty(VARIABLE_TYPE, ANALOG_UNIT_TYPE, "AnalogUnitType", 15_318),
    root(REFERENCE_TYPE, REFERENCES, "References", 91),
    ty(REFERENCE_TYPE, 32, "NonHierarchicalReferences", REFERENCES),
    ty(REFERENCE_TYPE, 33, "HierarchicalReferences", REFERENCES),
    ty(REFERENCE_TYPE, 34, "HasChild", 33),
    ty(REFERENCE_TYPE, ORGANIZES, "Organizes", 33),
    ty(REFERENCE_TYPE, 44, "Aggregates", 34),
    ty(REFERENCE_TYPE, HAS_SUBTYPE, "HasSubtype", 34),
    ty(REFERENCE_TYPE, HAS_PROPERTY, "HasProperty", 44),
    ty(REFERENCE_TYPE, HAS_COMPONENT, "HasComponent", 44),
    ty(REFERENCE_TYPE, HAS_TYPE_DEFINITION, "HasTypeDefinition", 32),
    ty(REFERENCE_TYPE, HAS_ENCODING, "HasEncoding", 32),
    root(DATA_TYPE, 24, "BaseDataType", 90),
    ty(DATA_TYPE, 1, "Boolean", 24),
    ty(DATA_TYPE, 12, "String", 24),
    ty(DATA_TYPE, 295, "LocaleId", 12),
    ty(DATA_TYPE, 13, "DateTime", 24),
    ty(DATA_TYPE, 294, "UtcTime", 13),
    ty(DATA_TYPE, 15, "ByteString", 24),
    ty(DATA_TYPE, 17, "NodeId", 24),
    ty(DATA_TYPE, 21, "LocalizedText", 24),
    ty(DATA_TYPE, 22, "Structure", 24),
    ty(DATA_TYPE, 862, "ServerStatusDataType", 22),
    ty(DATA_TYPE, 887, "EUInformation", 22),
    ty(DATA_TYPE, 29, "Enumeration", 24),
    ty(DATA_TYPE, 852, "ServerState", 29),
    ty(DATA_TYPE, 26, "Number", 24),
    ty(DATA_TYPE, 10, "Float", 26),
    ty(DATA_TYPE, 11, "Double", 26),
    ty(DATA_TYPE, 290, "Duration", 11),
    ty(DATA_TYPE, 27, "Integer", 26),
    ty(DATA_TYPE, 2, "SByte", 27),
    ty(DATA_TYPE, 4, "Int16", 27),
    ty(DATA_TYPE, 6, "Int32", 27),
    ty(DATA_TYPE, 8, "Int64", 27),
    ty(DATA_TYPE, 28, "UInteger", 26),
    ty(DATA_TYPE, 3, "Byte", 28),
    ty(DATA_TYPE, 5, "UInt16", 28),
    ty(DATA_TYPE, 7, "UInt32", 28),
    ty(DATA_TYPE, 9, "UInt64", 28),
];

/// The node with a number.
pub fn row(id: u32) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.id == id)
}

/// Whether a reference is of a type or, if `subtypes`, of one below it.
pub fn is_kind_of(reference: u32, wanted: u32, subtypes: bool) -> bool {
    let mut at = reference;
    loop {
        if at == wanted {
            return true;
        }
        match row(at).filter(|row| subtypes && row.reference == HAS_SUBTYPE) {
            Some(row) => at = row.parent,
            None => return false,
        }
    }
}
