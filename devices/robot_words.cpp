#include "devices/robot_words.h"

#include <algorithm>
#include <array>
#include <set>

namespace seamwright {
namespace {

// Sources: KUKA System Software 8.x, "KRL reference"; ABB "Technical reference manual: RAPID kernel"
// (reserved words) and "RAPID overview"; Universal Robots "The URScript Programming Language".
constexpr std::string_view kKrlWords =
    "AND ANIN ANOUT AXIS BAS BOOL BRAKE B_AND B_EXOR B_NOT B_OR CASE CAST_FROM CAST_TO CCLOSE CHANNEL CHAR "
    "CIRC "
    "CIRC_REL CIRC_TYPE CONFIRM CONST CONTINUE COPEN CREAD CWRITE CYCFLAG C_DIS C_ORI C_PTP C_SPL C_VEL DECL "
    "DEF "
    "DEFAULT DEFDAT DEFFCT DELAY DIGIN DISTANCE DO E3AXIS E3POS E6AXIS E6POS ELSE END ENDDAT ENDFCT ENDFOR "
    "ENDIF "
    "ENDLOOP ENDSPLINE ENDSWITCH ENDWHILE ENUM ERROR_T EXIT EXOR EXT EXTFCT FALSE FOR FRAME GLOBAL GOTO HALT "
    "IF "
    "IMPORT INT INTERRUPT IS LIN LIN_REL LOAD LOOP MAXIMUM MINIMUM NOT OFF ON ONSTART OR PATH POS PRIO PTP "
    "PTP_REL "
    "PTP_SPLINE PUBLIC PULSE REAL REPEAT RESUME RETURN SCIRC SEC SIGNAL SLIN SLIN_REL SPL SPLINE SPTP "
    "SPTP_REL "
    "SREAD STEP STRUC SWITCH SWRITE SYNC THEN TIME_BLOCK TO TRIGGER TRUE UNTIL WAIT WHEN WHILE WITH "
    // functions and programs that every controller has
    "ABS ACOS ATAN2 COS DEG FORWARD INVERSE INV_POS IR_STOPM MSGDIALOG MSGNOTIFY MSGQUIT MSGSTATE OTTO ROUND "
    "SIN SPS SQRT STRADD STRCLEAR STRCOMP STRCOPY STRDECLLEN STRFIND STRLEN STRTOBOOL STRTOINT STRTOREAL "
    "STRTOSTRING "
    "TAN VARSTATE VARTYPE CELL P00 CONFIG";
constexpr std::string_view kRapidWords =
    "ALIAS AND BACKWARD CASE CONNECT CONST DEFAULT DIV DO ELSE ELSEIF ENDFOR ENDFUNC ENDIF ENDMODULE ENDPROC "
    "ENDRECORD ENDTEST ENDTRAP ENDWHILE ERROR EXIT FALSE FOR FROM FUNC GOTO IF INOUT LOCAL MOD MODULE "
    "NOSTEPIN NOT "
    "NOVIEW OR PERS PROC RAISE READONLY RECORD RETRY RETURN STEP SYSMODULE TEST THEN TO TRAP TRUE TRYNEXT "
    "UNDO VAR "
    "VIEWONLY WHILE WITH XOR "
    // types
    "BOOL BYTE CLOCK CONFDATA DATAPOS DIONUM DNUM ERRNUM EXTJOINT INTNUM IODEV JOINTTARGET LOADDATA MECUNIT "
    "NUM "
    "ORIENT POS POSE PROGDISP ROBJOINT ROBTARGET RAWBYTES SIGNALDI SIGNALDO SIGNALGI SIGNALGO SOCKETDEV "
    "SOCKETSTATUS "
    "SPEEDDATA STRING SWITCH SYMNUM TASKS TOOLDATA TRIGGDATA WOBJDATA ZONEDATA "
    // routines and values that every controller has
    "ABS ACCSET ARGNAME BREAK CJOINTT CLKREAD CLKRESET CLKSTART CONFJ CONFL CPOS CROBT DEFFRAME DISPTIME "
    "EXITCYCLE "
    "FINE INCR INTNO INPOS MAIN MAXROBSPEED MOVEABSJ MOVEC MOVEJ MOVEL NOT_DEFINED NOROBOT OFFS ORIENTZYX "
    "PDISPOFF "
    "PDISPON PI POSEINV POSEMULT POSEVECT PULSEDO RELTOOL RESET ROUND SET SETDO SINGAREA SOCKETCLOSE "
    "SOCKETCONNECT "
    "SOCKETCREATE SOCKETRECEIVE SOCKETSEND STOP STOPMOVE STRFIND STRLEN STRMATCH STRPART STRTOVAL STARTMOVE "
    "TOOL0 "
    "TPERASE TPWRITE TRIGGEQUIP TRIGGINT TRIGGIO TRIGGJ TRIGGL TRUNC VALTOSTR VELSET WAITDI WAITTIME "
    "WAITUNTIL WOBJ0 "
    "LOAD0 VMAX EMPTY BASE USER";
constexpr std::string_view kUrWords =
    "AND BREAK CASE CONTINUE DEF DEFAULT ELIF ELSE END FALSE FOR GLOBAL HALT IF IN JOIN KILL LOCAL MOD NONE "
    "NOT OR "
    "PASS RETURN RUN SEC SWITCH THREAD TRUE WHILE XOR "
    "ABS ACOS ASIN ATAN ATAN2 BINARY_LIST_TO_INTEGER CEIL COS D2R ENTER_CRITICAL EXIT_CRITICAL EXP FLOOR "
    "FORCE_MODE FREEDRIVE_MODE GET_INVERSE_KIN INTEGER_TO_BINARY_LIST INTERPOLATE_POSE LENGTH LOG MOVEC "
    "MOVEJ MOVEL "
    "MOVEP NORM PAUSE POINT_DIST POSE_ADD POSE_DIST POSE_INV POSE_SUB POSE_TRANS POPUP POW POWERDOWN PROGRAM "
    "R2D "
    "RANDOM ROTVEC2RPY RPY2ROTVEC SERVOC SERVOJ SET SIN SIZE SLEEP SOCKET_OPEN SOCKET_CLOSE SPEEDJ SPEEDL "
    "SQRT STOPJ "
    "STOPL STR_AT STR_CAT STR_FIND STR_LEN STR_SUB SYNC TAN TEXTMSG TO_NUM TO_STR TOOL WRENCH_TRANS P "
    "ENCODER_SET_TICK_COUNT TIME";
// Names of resources/robot, and what the programs written from a project are called.
constexpr std::string_view kModules =
    "SEAMWRIGHT SEAMWRIGHT_SPOTS SEAMWRIGHT_SUB SEAMWRIGHT_RSI SEAMWRIGHT_RUN SEAMWRIGHTRSI "
    "SEAMWRIGHTRSIRELATIVE "
    "SEAMWRIGHTEGM SEAMWRIGHTSERVER SEAMWRIGHTSPOTS SEAMWRIGHTTYPES SEAMWRIGHT_EGM SEAMWRIGHT_SERVER";

std::set<std::string> words_of(std::string_view text) {
    std::set<std::string> words;
    while (!text.empty()) {
        const auto end = std::min(text.find(' '), text.size());
        if (end > 0) words.emplace(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return words;
}

std::string upper(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return out;
}

}  // namespace

std::string_view to_string(RobotLanguage language) {
    switch (language) {
        case RobotLanguage::krl:
            return "KRL";
        case RobotLanguage::rapid:
            return "RAPID";
        case RobotLanguage::urscript:
            return "URScript";
    }
    return "";
}

bool is_robot_word(RobotLanguage language, std::string_view name) {
    static const std::array<std::set<std::string>, 3> words = {words_of(kKrlWords), words_of(kRapidWords),
                                                               words_of(kUrWords)};
    return words[static_cast<std::size_t>(language)].count(upper(name)) > 0;
}

Expected<void> check_program_name(const std::string& name, const std::string& where) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    if (name.empty() || name.size() > 20 || !letter(name.front()) ||
        !std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; }))
        return input_error("\"" + name + "\" is no name of a program", where,
                           "use a letter, then letters, digits and _, at most 20");
    for (const RobotLanguage language : {RobotLanguage::krl, RobotLanguage::rapid, RobotLanguage::urscript})
        if (is_robot_word(language, name))
            return input_error(
                "\"" + name + "\" is a word of " + std::string(to_string(language)) + " itself", where,
                "choose another name");
    static const std::set<std::string> modules = words_of(kModules);
    if (modules.count(upper(name)) > 0 || upper(name).starts_with("SW_") || upper(name).starts_with("XSW_"))
        return input_error("\"" + name + "\" is a name of Seamwright's own modules", where,
                           "choose another name");
    return {};
}

}  // namespace seamwright
