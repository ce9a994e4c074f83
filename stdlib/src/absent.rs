//! The names of the instructions that STEP 7 and the TIA Portal have, by group of their catalogues.
//!
//! A name that neither the standard library nor a table of plcc has is one that plcc does not have: a program that
//! uses it gets a message that says so, rather than that the name is unknown. Names that plcc has may be here, too;
//! the library comes first. Instructions that plcc has in some of its languages are not here: they are unknown only
//! in the others.

use crate::BlockClass;

/// Instructions that stand together in a catalogue.
#[derive(Debug)]
pub struct Group {
    /// Whose instructions they are: `TIA Portal`, `STEP 7`.
    pub tool: &'static str,
    /// The heading in the catalogue.
    pub name: &'static str,
    names: &'static [&'static str],
}

const fn tia(name: &'static str, names: &'static [&'static str]) -> Group {
    Group { tool: "the TIA Portal", name, names }
}

const fn step7(name: &'static str, names: &'static [&'static str]) -> Group {
    Group { tool: "STEP 7", name, names }
}

/// The catalogues. Source: TIA Portal help with that of STEP 7 Safety, and the help of STEP 7 V5, lists of instructions.
#[rustfmt::skip]
const GROUPS: &[Group] = &[
    // Basic instructions.
    tia("bit logic", &[
        "SETP", "RESETP",
    ]),
    tia("timers and counters", &[
        "RESET_TIMER", "PRESET_TIMER", "IEC_TIMER", "IEC_LTIMER", "TP_TIME", "TP_LTIME", "TON_TIME", "TON_LTIME", "TOF_TIME",
        "TOF_LTIME", "TONR_TIME", "TONR_LTIME", "CTU_SINT", "CTU_USINT", "CTU_UINT", "IEC_COUNTER", "IEC_SCOUNTER", "IEC_USCOUNTER",
        "IEC_UCOUNTER", "IEC_DCOUNTER", "IEC_UDCOUNTER", "IEC_LCOUNTER", "IEC_ULCOUNTER",
    ]),
    tia("comparator operations", &[
        "EQ_Type", "NE_Type", "EQ_ElemType", "NE_ElemType", "EQ_TypeOfDB", "NE_TypeOfDB", "IS_NULL", "NOT_NULL", "IS_ARRAY", "T_COMP",
        "S_COMP", "TypeOf", "TypeOfElements", "TypeOfDB", "CompType",
    ]),
    tia("move operations", &[
        "AssignmentAttempt", "ReadFromArrayDB", "WriteToArrayDB", "ReadFromArrayDBL", "WriteToArrayDBL", "BLKMOV", "UBLKMOV", "FILL",
        "FieldRead", "FieldWrite", "PEEK", "PEEK_BOOL", "POKE", "POKE_BOOL", "POKE_BLK", "READ_LITTLE", "READ_BIG", "WRITE_LITTLE",
        "WRITE_BIG", "VariantToDB_ANY", "GetSymbolName", "GetSymbolPath", "GetSymbolForReference", "GetInstanceName", "GetInstancePath",
        "GetBlockName", "ResolveSymbols", "MoveFromResolvedSymbol", "MoveToResolvedSymbol", "MoveResolvedSymbolsToBuffer",
        "MoveResolvedSymbolsFromBuffer", "MOVE_DIRECT",
    ]),
    tia("conversion operations", &[
        "UNSCALE", "REF", "DB_ANY_TO_VARIANT", "VARIANT_TO_DB_ANY", "VARIANT_TO_ANY", "ANY_TO_VARIANT", "DB_ANY_TO_UINT",
        "UINT_TO_DB_ANY", "DB_ANY_TO_WORD", "WORD_TO_DB_ANY",
    ]),
    tia("program control", &[
        "LABEL", "ENDIS_PW", "SHUT_DOWN", "INIT_RD", "RTM", "CAUSE_ERROR",
    ]),
    tia("legacy instructions", &[
        "BSUM", "SEG", "BCDCPL", "RESETI", "SETI", "RSET", "SET", "SHRB", "WSR", "DRUM", "DRUM_X", "DCAT", "MCAT", "ATTR_DB", "FIFO",
        "LIFO", "TBL", "TBL_FIND", "TBL_TBL", "TBL_WRD", "WRD_TBL", "IBLKMOV", "CDT", "DEV", "LEAD_LAG", "IMC", "SMC", "PACK", "ATT",
    ]),
    // Extended instructions.
    tia("date and time of day", &[
        "SET_TIMEZONE", "SNC_RTCB", "TIME_TCK", "SET_CLK", "READ_CLK", "SET_CLKS", "CONCAT_DATE_TOD", "CONCAT_DATE_LTOD",
    ]),
    tia("string and character", &[
        "JOIN", "SPLIT",
    ]),
    tia("process image", &[
        "UPDAT_PI", "UPDAT_PO", "SYNC_PI", "SYNC_PO", "T_CONFIG",
    ]),
    tia("distributed I/O", &[
        "RDREC", "WRREC", "GETIO", "SETIO", "GETIO_PART", "SETIO_PART", "RALRM", "D_ACT_DP", "DPSYC_FR", "DPNRM_DG", "DP_TOPOL",
        "DPRD_DAT", "DPWR_DAT", "RCVREC", "PRVREC", "PE_START_END", "PE_CMD", "PE_DS3_Write_ET200S", "PE_WOL", "PE_I_DEV",
        "PE_Error_RSP", "PE_List_Modes_RSP", "PE_Get_Mode_RSP", "PE_PEM_Status_RSP", "PE_Identify_RSP", "PE_Measurement_List_RSP",
        "PE_Measurement_Value_RSP", "ReconfigIOSystem", "DP_PRAL", "SALRM", "LIO_SYNC", "RDSYSST", "WR_PARM", "WR_DPARM", "PARM_MOD",
        "WR_REC", "RD_REC", "DS_WRITE", "DS_READ", "RD_DPAR", "RD_DPARA", "RD_DPARM", "ASI_CTRL", "ASi_3422", "IO_LINK_CALL",
        "IO_LINK_DEVICE", "LIOLink_Device", "ET200SMotor", "ReadFlexIO", "PNIO_STATE",
    ]),
    tia("interrupts", &[
        "SET_TINT", "SET_TINTL", "CAN_TINT", "ACT_TINT", "QRY_TINT", "MSK_FLT", "DMSK_FLT", "READ_ERR", "DIS_IRT", "EN_IRT", "MP_ALM",
    ]),
    tia("alarms", &[
        "Program_Alarm", "Get_AlarmState", "Gen_UsrMsg", "Get_Alarm", "Get_AlarmResources", "Ack_Alarms", "Ack_Alarm", "ALARM",
        "ALARM_8", "ALARM_8P", "NOTIFY", "NOTIFY_8P", "ALARM_SQ", "ALARM_S", "ALARM_SC", "ALARM_DQ", "ALARM_D", "AR_SEND", "EN_MSG",
        "DIS_MSG", "WR_USMSG", "READ_SI", "DEL_SI",
    ]),
    tia("diagnostics", &[
        "RD_SINFO", "LED", "Get_IM_Data", "Get_Name", "GetStationInfo", "GetChecksum", "DeviceStates", "ModuleStates", "GEN_DIAG",
        "GET_DIAG", "RT_INFO", "RD_LGADR", "LOG2GEO", "GEO2LOG", "LOG2MOD", "IO2MOD", "RD_ADDR", "GADR_LGC", "LGC_GADR", "GetSMCinfo",
        "SetBusNode", "GetClockStatus", "SetSMCStatus",
    ]),
    tia("pulses", &[
        "CTRL_PTO",
    ]),
    tia("recipes and data logging", &[
        "RecipeExport", "RecipeImport", "DataLogCreate", "DataLogOpen", "DataLogWrite", "DataLogClear", "DataLogClose", "DataLogNewFile",
        "DataLogDelete", "DataLogTypedCreate", "DataLogTypedOpen", "FileReadC", "FileWriteC", "FileDelete", "FileRead", "FileWrite",
    ]),
    tia("data block control", &[
        "CREATE_DB", "READ_DBL", "WRIT_DBL", "ATTR_DB", "DELETE_DB", "CREA_DBL", "CREA_DB", "DEL_DB", "TEST_DB", "COMPRESS",
    ]),
    tia("addressing", &[
        "GEO2LOG", "LOG2GEO", "IO2MOD", "RD_ADDR", "GEOADDR",
    ]),
    tia("plant and user administration", &[
        "SET_FEATURE_BIT", "LIC_CHECK", "GetLicense", "LockPassword", "SetPassword", "ReadWritePassword", "UserLogin", "UserLogout",
        "Get_UserRights",
    ]),
    // Technology.
    tia("fast counting and measurement", &[
        "High_Speed_Counter", "HighSpeed_Counter", "SSI_Absolute_Encoder", "CountFrequencyPeriod", "MeasureInput",
        "OutputCam", "FM350", "CNT_CTRL", "CNT_CTL1", "CNT_CTL2", "DIAG_INF",
    ]),
    tia("PID control", &[
        "PID_3Step", "PID_Temp", "CONT_C", "CONT_S", "PULSEGEN", "TCONT_CP", "TCONT_S", "PID_ES", "PID_CP", "CONT_C_SF", "CONT_S_SF",
        "PULSGEN_M", "Polyline", "SplitRange", "RampFunction", "RampSoak", "Filter_PT1", "Filter_PT2", "Filter_DT1", "Filter_Universal",
        "Auto_Manual", "TUN_EC", "TUN_ES", "PID_Compact_V2", "PID_3Step_V2", "PID_Temp_V1",
    ]),
    tia("motion control", &[
        "MC_Power", "MC_Reset", "MC_Home", "MC_Halt", "MC_Stop", "MC_MoveAbsolute", "MC_MoveRelative", "MC_MoveVelocity", "MC_MoveJog",
        "MC_MoveSuperimposed", "MC_MoveAdditive", "MC_CommandTable", "MC_ChangeDynamic", "MC_WriteParam", "MC_ReadParam",
        "MC_WriteParameter", "MC_ReadParameter", "MC_SetSensor", "MC_SetAxisSTW", "MC_GearIn", "MC_GearInPos", "MC_GearOut",
        "MC_GearInVelocity", "MC_CamIn", "MC_CamOut", "MC_PhasingAbsolute", "MC_PhasingRelative", "MC_OffsetAbsolute",
        "MC_OffsetRelative", "MC_SynchronizedMotionSimulation", "MC_LeadingValueAdditive", "MC_InterpolateCam", "MC_GetCamLeadingValue",
        "MC_GetCamFollowingValue", "MC_CopyCamData", "MC_MeasuringInput", "MC_MeasuringInputCyclic", "MC_AbortMeasuringInput",
        "MC_OutputCam", "MC_CamTrack", "MC_TorqueLimiting", "MC_TorqueAdditive", "MC_TorqueRange", "MC_HaltPhasing", "MC_StopPhasing",
        "MC_GroupStop", "MC_GroupContinue", "MC_GroupInterrupt", "MC_MoveLinearAbsolute", "MC_MoveLinearRelative",
        "MC_MoveCircularAbsolute", "MC_MoveCircularRelative", "MC_MoveDirectAbsolute", "MC_MoveDirectRelative", "MC_TrackConveyorBelt",
        "MC_DefineWorkspaceZone", "MC_DefineKinematicsZone", "MC_SetWorkspaceZoneActive", "MC_SetWorkspaceZoneInactive",
        "MC_SetKinematicsZoneActive", "MC_SetKinematicsZoneInactive", "MC_DefineTool", "MC_SetTool", "MC_SetOcsFrame",
        "MC_KinematicsMotionSimulation", "MC_KinematicsTransformation", "MC_InverseKinematicsTransformation", "MC_MotionInVelocity",
        "MC_MotionInPosition", "MC_MotionInSuperimposed", "MC_SaveAbsoluteEncoderData", "MC_LoadKinematics", "MC_RunMcl",
        "MC_LoadProgram", "TO_Axis", "TO_PositioningAxis", "TO_SpeedAxis", "TO_SynchronousAxis", "TO_ExternalEncoder", "TO_CommandTable",
        "TO_CamTrack", "TO_OutputCam", "TO_MeasuringInput", "TO_Cam", "TO_Kinematics", "TO_LeadingAxisProxy", "TO_Interpreter",
        "SINA_POS", "SINA_SPEED", "SINA_PARA", "SINA_PARA_S", "SINA_INFEED", "SINA_POS_TEL111", "SinaPos", "SinaSpeed", "SinaPara",
        "TM_Timer_DIDQ", "TIO_SYNC", "TIO_DI", "TIO_DQ", "TIO_IOLink_IN", "TIO_IOLink_OUT",
    ]),
    // Communication.
    tia("S7 communication", &[
        "PUT", "GET", "USEND", "URCV", "BSEND", "BRCV", "X_SEND", "X_RCV", "X_GET", "X_PUT", "X_ABORT", "I_GET", "I_PUT", "I_ABORT",
        "C_DIAG", "C_CNTRL", "USEND_S", "URCV_S",
    ]),
    tia("open user communication", &[
        "TMAIL_C", "TUSEND", "TURCV", "TCONSettings", "T_RESET", "T_DIAG", "TCON_Param", "TCON_IP_v4", "TCON_IP_v4_SEC", "TCON_QDN",
        "TCON_QDN_SEC", "TADDR_Param", "TSEND_V6", "CommConfig", "IP_CONF", "SEND_FTP", "FTP_CMD", "AG_SEND",
        "AG_RECV", "AG_LSEND", "AG_LRECV", "AG_LOCK", "AG_UNLOCK", "AG_CNTRL", "AG_CNTEX", "LCC_Publisher", "LMQTT_Client",
        "LHTTP_Client", "SNMP_Get", "MQTT_Client",
    ]),
    tia("OPC UA", &[
        "OPC_UA_Connect", "OPC_UA_Disconnect", "OPC_UA_NamespaceGetIndexList", "OPC_UA_NodeGetHandleList",
        "OPC_UA_NodeReleaseHandleList", "OPC_UA_MethodGetHandleList", "OPC_UA_MethodReleaseHandleList", "OPC_UA_TranslatePathList",
        "OPC_UA_ReadList", "OPC_UA_WriteList", "OPC_UA_MethodCall", "OPC_UA_ConnectionGetStatus", "OPC_UA_ServerMethodPre",
        "OPC_UA_ServerMethodPost", "OPC_UA_ReadList_Safe", "OPC_UA_WriteList_Safe", "OPC_UA_MethodGetHandle",
        "OPC_UA_SubscriptionCreate", "OPC_UA_MonitoredItemAdd",
    ]),
    tia("web server", &[
        "WWW",
    ]),
    tia("MODBUS", &[
        "MB_CLIENT", "MB_SERVER", "MB_RED_CLIENT", "MB_RED_SERVER", "MODBUSCP", "MODBUSPN", "Modbus_Comm_Load", "Modbus_Master",
        "Modbus_Slave", "MB_COMM_LOAD", "MB_MASTER", "MB_SLAVE", "MOD_CLI", "MOD_SERV",
    ]),
    tia("communication modules", &[
        "Port_Config", "Send_Config", "Receive_Config", "Send_P2P", "Receive_P2P", "Receive_Reset", "Signal_Get", "Signal_Set",
        "Get_Features", "Set_Features", "P3964_Config", "PORT_CFG", "SEND_CFG", "RCV_CFG", "SEND_PTP", "RCV_PTP", "RCV_RST", "SGN_GET",
        "SGN_SET", "USS_Port_Scan", "USS_Port_Scan_31", "USS_Drive_Control", "USS_Drive_Control_31", "USS_Read_Param", "USS_Write_Param",
        "USS_PORT", "USS_DRV", "USS_RPM", "USS_WPM", "P_SEND", "P_RCV", "P_RESET", "S_RCV", "S_SEND", "S_V24", "S_VSTAT", "S_VSET",
        "S_XON", "S_RTS", "S_MODB", "S_USST", "S_USSR", "S_USSI", "TC_CON", "TC_DISCON", "TC_SEND", "TC_RECV", "TC_CONFIG", "PN_InOut",
        "LOGICAL_TRIGGER", "GPRSComm", "SMS_Send", "SMS_Receive",
    ]),
    tia("SIMATIC Ident", &[
        "Read", "Read_EPC_Mem", "Read_TID", "Read_UID", "Reset_Reader", "Set_Ant_RF300", "Set_Param_RF680R", "Write_EPC_ID",
        "Write_EPC_Mem", "AdvancedCmd", "Ident_Profile", "Inventory", "Config_Upload", "Config_Download", "Reader_Status", "Tag_Status",
        "Read_MV", "Write_MV", "Reset_MOBY_D", "Reset_MOBY_U", "Reset_MV", "Reset_RF200", "Reset_RF300", "Reset_RF600", "Reset_Univ",
    ]),
    tia("teleservice", &[
        "TM_MAIL", "PG_DIAL", "SMS_SEND", "AS_MAIL", "AS_DIAL",
    ]),
    tia("safety functions, for fail-safe CPUs", &[
        "ESTOP1", "TWO_HAND", "TWO_H_EN", "MUTING", "MUT_P", "EV1oo2DI", "FDBACK", "SFDOOR", "ACK_GL", "ACK_OP", "BO_W", "W_BO",
        "RD_FDB", "WR_FDB", "SENDDP", "RCVDP", "SENDS7", "RCVS7",
    ]),
    // STEP 7 V5.
    step7("system functions (SFC)", &[
        "SET_CLK", "READ_CLK", "SET_RTM", "CTRL_RTM", "READ_RTM", "GADR_LGC", "RD_SINFO", "DP_PRAL", "DPSYC_FR", "D_ACT_DP", "DPNRM_DG",
        "DPRD_DAT", "DPWR_DAT", "ALARM_SQ", "ALARM_S", "ALARM_SC", "BLKMOV", "FILL", "CREAT_DB", "DEL_DB", "TEST_DB", "COMPRESS",
        "UPDAT_PI", "UPDAT_PO", "SET_TINT", "CAN_TINT", "ACT_TINT", "QRY_TINT", "SRT_DINT", "CAN_DINT", "QRY_DINT", "MP_ALM", "MSK_FLT",
        "DMSK_FLT", "READ_ERR", "DIS_IRT", "EN_IRT", "DIS_AIRT", "EN_AIRT", "RE_TRIGR", "REPL_VAL", "STP", "WAIT", "SNC_RTCB",
        "LGC_GADR", "RD_LGADR", "RDSYSST", "WR_USMSG", "WR_PARM", "WR_DPARM", "PARM_MOD", "WR_REC", "RD_REC", "GD_SND", "GD_RCV",
        "USEND", "CONTROL", "TIME_TCK", "X_SEND", "X_RCV", "X_GET", "X_PUT", "X_ABORT", "GEO_LOG", "LOG_GEO", "I_GET", "I_PUT",
        "I_ABORT", "SET", "RSET", "SET_SW", "SET_SW_S", "UBLKMOV", "CREA_DBL", "READ_DBL", "WRIT_DBL", "CREA_DB", "C_CNTRL", "H_CTRL",
        "SET_CLKS", "RTM", "RD_DPARA", "SYNC_PI", "SYNC_PO", "PN_IN", "PN_OUT", "ALARM_DQ", "ALARM_D", "READ_SI", "DEL_SI", "IP_CONFIG",
        "AB_CALL", "DBSYNC", "EN_MSG", "DIS_MSG", "PN_DP",
    ]),
    step7("system function blocks (SFB)", &[
        "BSEND", "BRCV", "USEND", "URCV", "PUT", "GET", "PRINT", "START", "STOP", "RESUME", "STATUS", "USTATUS", "NOTIFY_8P", "DRUM",
        "ALARM", "ALARM_8", "ALARM_8P", "NOTIFY", "AR_SEND", "CONT_C", "CONT_S", "PULSEGEN", "ANALOG", "DIGITAL", "COUNT", "FREQUENC",
        "PULSE", "RDREC", "WRREC", "RALRM", "SEND_PTP", "RCV_PTP", "RES_RCVB", "SEND_RK", "FETCH_RK", "SERVE_RK", "SALRM", "RCVREC",
        "PRVREC", "C_DIAG", "FREQ_MES", "A_HSC", "HSC_A_B", "POS", "ALG_CTRL", "CTU", "CTD", "CTUD", "TP", "TON", "TOF", "TSEND", "TRCV",
        "TCON", "TDISCON",
    ]),
    step7("standard library: IEC functions", &[
        "AD_DT_TM", "CONCAT", "D_TOD_DT", "DELETE", "DI_STRNG", "DT_DATE", "DT_DAY", "DT_TOD", "EQ_DT", "EQ_STRNG", "FIND", "GE_DT",
        "GE_STRNG", "GT_DT", "GT_STRNG", "I_STRNG", "INSERT", "LE_DT", "LE_STRNG", "LEFT", "LEN", "LIMIT", "LT_DT", "LT_STRNG", "MAX",
        "MID", "MIN", "NE_DT", "NE_STRNG", "R_STRNG", "REPLACE", "RIGHT", "S5TI_TIM", "SB_DT_DT", "SB_DT_TM", "SEL", "STRNG_DI",
        "STRNG_I", "STRNG_R", "TIM_S5TI",
    ]),
    step7("standard library: S5-S7 converting blocks", &[
        "ADD_32", "SUB_32", "MUL_16", "DIV_16", "GP_FPGP", "GP_GPFP", "GP_ADD", "GP_SUB", "GP_MUL", "GP_DIV", "GP_VGL", "GP_RAD",
        "ADD_FP", "CODE_B4", "COD_B4", "COD_16", "MUL_32", "DIV_32", "RAD_16", "REG_SCHB", "REG_SCHW", "REG_FIFO", "REG_LIFO",
        "DB_COPY1", "DB_COPY2", "RETTEN", "LADEN", "BITSUM1", "AE_460_1", "AE_460_2", "AE_463_1", "AE_464_1", "AE_464_2", "AE_466_1",
        "AE_466_2", "RLG_AA1", "RLG_AA2", "PER_ET1", "PER_ET2", "SINUS", "COSINUS", "TANGENS", "COTANG", "ARCSIN", "ARCCOS", "ARCTAN",
        "ARCCOT", "LN_X", "LG_X", "B_LOG_X", "E_H_N", "ZEHN_H_N", "A2_H_A1", "MELD_TLC", "MELD_TYP",
    ]),
    step7("standard library: TI-S7 converting blocks", &[
        "TONR", "IBLKMOV", "RSET", "SET", "ATT", "FIFO", "TBL_FIND", "LIFO", "TBL", "TBL_WRD", "WSR", "WRD_TBL", "SHRB", "SEG", "ATH",
        "HTA", "ENCO", "DECO", "BCDCPL", "BITSUM", "RSETI", "SETI", "DEV", "CDT", "TBL_TBL", "SCALE", "UNSCALE", "LEAD_LAG", "DCAT",
        "MCAT", "IMC", "SMC", "DRUM", "PACK",
    ]),
    step7("standard library: communication blocks", &[
        "AG_SEND", "AG_RECV", "AG_LSEND", "AG_LRECV", "AG_LOCK", "AG_UNLOCK", "AG_CNTRL", "PUT_E", "GET_E", "IP_CONF", "LOGICAL_TRIGGER",
        "PNIO_SEND", "PNIO_RECV", "PNIO_RW_REC", "PNIO_ALARM", "FTP_CONNECT", "FTP_STORE", "FTP_RETRIEVE", "FTP_DELETE", "FTP_QUIT",
        "FTP_CMD", "DP_SEND", "DP_RECV", "DP_DIAG", "DP_CTRL", "FMS_READ", "FMS_WRITE", "FMS_REPORT", "FMS_IDENTIFY", "FMS_STATUS",
        "FETCH", "WRITE_DB", "MODBUS_SLAVE", "P_SND_RK", "P_RCV_RK",
    ]),
    step7("distributed I/O and drives", &[
        "TIMESTMP", "FMT_PID", "FMT_PAR", "FMT_CJ_T", "FMT_DS1", "FMT_TUN", "FMT_PV", "CH_DIAG", "PID_FM", "FORCE355", "READ_355",
        "PID_PAR", "CJ_T_PAR", "CNT_CTRL", "CNT_CTL1", "CNT_CTL2", "DIAG_RD", "POS_CTRL", "POS_DIAG", "POS_MSRM", "DRV_CTRL", "ABS_INIT",
        "ABS_CTRL", "ABS_DIAG", "CAM_INIT", "CAM_CTRL", "CAM_DIAG", "CAM_MSRM", "FC_SSI", "PDAT_CY", "PDAT_AC", "PDAT_DL", "PDAT_UD",
        "PDAT_RD", "FB_PDAT", "RECV_440", "SEND_440", "RES_RECV",
    ]),
    step7("PID control", &[
        "CONT_C", "CONT_S", "PULSEGEN", "TCONT_CP", "TCONT_S", "PID_CP", "PID_ES", "LP_SCHED", "DEADBAND", "CRP_IN", "CRP_OUT", "LAG1ST",
        "LAG2ND", "LIMALARM", "LIMITER", "LMNGEN_C", "LMNGEN_S", "NONLIN", "NORM", "OVERRIDE", "PARA_CTL", "RMP_SOAK", "ROC_LIM",
        "SCALE_M", "SP_GEN", "SPLT_RAN", "SWITCH_M", "A_DEAD_B", "DIF", "ERR_MON", "INTEG", "LP_SCHED_M",
    ]),
];

/// System functions and function blocks of S7-300/400 CPUs that the library does not have.
/// Source: System and standard functions for S7-300 and S7-400, list of SFCs and SFBs; CPU 312 IFM/314 IFM, integrated functions.
#[rustfmt::skip]
const NUMBERS: &[(BlockClass, &[(u16, &str)])] = &[
    (BlockClass::Sfc, &[
        (7, "DP_PRAL"), (11, "DPSYC_FR"), (12, "D_ACT_DP"), (35, "MP_ALM"), (54, "RD_DPARM"), (60, "GD_SND"), (61, "GD_RCV"),
        (62, "CONTROL"), (63, "AB_CALL"), (65, "X_SEND"), (66, "X_RCV"), (67, "X_GET"), (68, "X_PUT"), (69, "X_ABORT"),
        (72, "I_GET"), (73, "I_PUT"), (74, "I_ABORT"), (87, "C_DIAG"), (90, "H_CTRL"), (99, "WWW"), (103, "DP_TOPOL"),
        (104, "CiR"), (105, "READ_SI"), (106, "DEL_SI"), (109, "PROTECT"), (112, "PN_IN"), (113, "PN_OUT"), (114, "PN_DP"),
    ]),
    (BlockClass::Sfb, &[
        (16, "PRINT"), (19, "START"), (20, "STOP"), (21, "RESUME"), (22, "STATUS"), (23, "USTATUS"), (29, "HS_COUNT"),
        (30, "FREQ_MES"), (38, "HSC_A_B"), (39, "POS"), (44, "ANALOG"),
        (46, "DIGITAL"), (47, "COUNT"), (48, "FREQUENC"), (49, "PULSE"), (60, "SEND_PTP"), (61, "RCV_PTP"), (62, "RES_RCVB"),
        (63, "SEND_RK"), (64, "FETCH_RK"), (65, "SERVE_RK"), (73, "RCVREC"), (74, "PRVREC"), (104, "IP_CONF"),
    ]),
];

/// The name of a block of S7-300/400 CPUs that the library does not have, by number.
pub fn absent_system_block(class: BlockClass, number: u16) -> Option<&'static str> {
    let (_, blocks) = NUMBERS.iter().find(|(own, _)| *own == class)?;
    blocks.iter().find(|(own, _)| *own == number).map(|(_, name)| *name)
}

/// Data types of the system that the TIA Portal has and plcc does not. Source: TIA Portal help, system data types, start information of
/// organization blocks, open user communication, OPC UA.
#[rustfmt::skip]
const TYPES: &[&str] = &[
    "SI_none", "SI_ProgramCycle", "SI_TimeOfDay", "SI_Delay", "SI_Cyclic", "SI_ProcessInterrupt", "SI_SynchCycle", "SI_TimeError",
    "SI_DiagnosticInterrupt", "SI_PlugPullModule", "SI_StationFailure", "SI_Startup", "SI_ProgIOAccessError", "SI_Servo", "SI_Ipo",
    "TCON_Configured", "TCON_IP_V6", "TADDR_SEND_QDN", "TADDR_RCV_IP", "TMail_V6", "TMail_V4_SEC", "TMail_V6_SEC", "TMail_QDN_SEC",
    "IF_CONF_NTP", "IF_CONF_DNS", "OPC_UA_NodeId", "OPC_UA_SessionConnectInfo", "OPC_UA_NodeAdditionalInfo",
];

/// The name of a data type of the system that plcc does not have, as the TIA Portal writes it.
pub fn absent_type(name: &str) -> Option<&'static str> {
    let name = name.trim().trim_matches('"');
    TYPES.iter().copied().find(|known| known.eq_ignore_ascii_case(name))
}

/// The group of the catalogues that has an instruction of this name, in any letter case, and the name as written there. None: no
/// catalogue has it, or the library of plcc has it.
pub fn catalogued(name: &str) -> Option<(&'static Group, &'static str)> {
    let name = name.trim().trim_matches('"');
    let shipped =
        |block: &&crate::SystemBlock| block.form != crate::Form::NotShipped && block.name.eq_ignore_ascii_case(name);
    if crate::blocks().iter().any(|block| shipped(&block)) {
        return None;
    }
    GROUPS.iter().find_map(|group| {
        group.names.iter().find(|known| known.eq_ignore_ascii_case(name)).map(|known| (group, *known))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn catalogue_is_large_and_findable() {
        let count: usize = GROUPS.iter().map(|group| group.names.len()).sum();
        assert!(count > 700, "{count}");
        let place = |name| catalogued(name).map(|(group, written)| (group.tool, group.name, written));
        assert_eq!(place("mc_moveadditive"), Some(("the TIA Portal", "motion control", "MC_MoveAdditive")));
        assert_eq!(place("RETTEN"), Some(("STEP 7", "standard library: S5-S7 converting blocks", "RETTEN")));
        assert_eq!(catalogued("Motor").map(|(_, name)| name), None);
    }

    #[test]
    fn what_the_library_has_is_not_absent() {
        let shipped: Vec<&str> = crate::blocks()
            .iter()
            .filter(|block| block.form != crate::Form::NotShipped)
            .map(|block| block.name)
            .collect();
        assert!(shipped.len() > 100, "{}", shipped.len());
        let absent: Vec<&&str> = shipped.iter().filter(|name| catalogued(name).is_some()).collect();
        assert_eq!(absent, Vec::<&&str>::new());
        assert!(shipped.contains(&"BLKMOV") && catalogued("RETTEN").is_some());
    }

    #[test]
    fn blocks_that_the_library_has_are_not_absent() {
        for (class, blocks) in NUMBERS {
            for (number, name) in *blocks {
                assert!(crate::find(*class, *number).is_none(), "{name}");
            }
        }
        assert_eq!(absent_system_block(BlockClass::Sfc, 65), Some("X_SEND"));
        assert_eq!(absent_system_block(BlockClass::Sfc, 20), None);
        assert_eq!(absent_system_block(BlockClass::Fc, 65), None);
    }

    #[test]
    fn a_group_has_each_name_once() {
        for group in GROUPS {
            for (at, name) in group.names.iter().enumerate() {
                let again = group.names[at + 1..].contains(name);
                assert!(!again, "{name} in {}", group.name);
            }
        }
    }
}
