#include "devices/kuka/rsi_program.h"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <sstream>

#include "devices/exchange/settings.h"
#include "devices/kuka/program.h"
#include "devices/kuka/rsi.h"
#include "kuka_resources.h"

namespace seamwright {
namespace {

struct Values {
    std::string listen = "127.0.0.1", sen_type = "ImFree", mode = "absolute", reference = "base";
    int port = 49152, path_output = 101, release_output = 102;
    double max_translation_mm = 10, max_rotation_deg = 2;
    bool relative() const { return mode == "relative"; }
    bool tool() const { return reference == "tool"; }
};

Expected<Values> read_values(const nlohmann::json& settings) {
    Values v;
    SettingsReader f(settings, "settings", kuka_rsi_settings(), UnknownSettings::passed_over);
    f.text("listen", v.listen);
    f.text("sen_type", v.sen_type);
    f.text("mode", v.mode);
    f.text("reference", v.reference);
    f.whole("port", v.port);
    f.whole("path_output", v.path_output);
    f.whole("release_output", v.release_output);
    f.number("max_translation_mm", v.max_translation_mm);
    f.number("max_rotation_deg", v.max_rotation_deg);
    if (f.failed()) return tl::unexpected(f.error());
    if (v.port == 0)
        return input_error("a controller connects to no port 0", "settings.port", "give 1 to 65535");
    if (v.path_output == v.release_output)
        return input_error("path and release have one output", "settings.release_output", "give it another");
    return v;
}

// Our own resource; pugixml writes what is in it escaped.
pugi::xml_document loaded(std::string_view text) {
    pugi::xml_document document;
    document.load_buffer(text.data(), text.size(), pugi::parse_full);
    return document;
}

std::string written(const pugi::xml_document& document) {
    std::ostringstream out;
    document.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
    return out.str();
}

// Every value of the context by object and parameter, for both of its files.
struct Parameter {
    const char *object, *name;
    std::string value, visual;  // `visual`: as RSI Visual names it
};
std::vector<Parameter> parameters(const Values& v, const std::string& name) {
    const std::string mm = fmt::format("{}", v.max_translation_mm);
    const std::string deg = fmt::format("{}", v.max_rotation_deg);
    std::vector<Parameter> all = {
        {"ETHERNET1", "ConfigFile", name + ".xml", name + ".xml"},
        {"POSCORR1", "MaxRotAngle", deg, deg},
        {"POSCORR1", "RefCorrSys", v.tool() ? "3" : "1", v.tool() ? "Tool" : "Base"},
        {"POSCORRMON1", "MaxTrans", mm, mm},
        {"POSCORRMON1", "MaxRotAngle", deg, deg},
        {"PATH_OUT", "Index", std::to_string(v.path_output), std::to_string(v.path_output)},
        {"RELEASE_OUT", "Index", std::to_string(v.release_output), std::to_string(v.release_output)}};
    for (const char* limit : {"LowerLimX", "LowerLimY", "LowerLimZ"})
        all.push_back({"POSCORR1", limit, "-" + mm, "-" + mm});
    for (const char* limit : {"UpperLimX", "UpperLimY", "UpperLimZ"})
        all.push_back({"POSCORR1", limit, mm, mm});
    return all;
}

std::string context(const Values& v, const std::string& name) {
    pugi::xml_document document =
        loaded(v.relative() ? resources::SeamwrightRsiRelative_rsi_xml : resources::SeamwrightRsi_rsi_xml);
    for (const Parameter& p : parameters(v, name)) {
        pugi::xml_node object =
            document.child("RSIObjects").find_child_by_attribute("RSIObject", "ObjID", p.object);
        object.child("Parameters")
            .find_child_by_attribute("Parameter", "Name", p.name)
            .attribute("ParamValue")
            .set_value(p.value.c_str());
    }
    return written(document);
}

std::string visual(const Values& v, const std::string& name) {
    pugi::xml_document document =
        loaded(v.relative() ? resources::SeamwrightRsiRelative_rsi : resources::SeamwrightRsi_rsi);
    for (const Parameter& p : parameters(v, name)) {
        pugi::xml_node object = document.child("rSIModel")
                                    .child("rSIObjects")
                                    .find_child_by_attribute("rSIElement", "name", p.object);
        object.child("rSIParameters")
            .find_child_by_attribute("rSIParameter", "name", p.name)
            .attribute("value")
            .set_value(p.visual.c_str());
    }
    return written(document);
}

std::string ethernet(const Values& v) {
    pugi::xml_document document =
        loaded(v.relative() ? resources::SeamwrightRsiRelative_xml : resources::SeamwrightRsi_xml);
    pugi::xml_node config = document.child("ROOT").child("CONFIG");
    config.child("IP_NUMBER").text().set(v.listen.c_str());
    config.child("PORT").text().set(v.port);
    config.child("SENTYPE").text().set(v.sen_type.c_str());
    return written(document);
}

void replace(std::string& text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
}

std::string program(const Values& v, const std::string& name) {
    std::string text(resources::seamwright_rsi_src);
    if (v.relative()) {
        replace(text, "SeamwrightRsi.", name + ".");
        replace(text, "#ABSOLUTE", "#RELATIVE");
    }
    if (v.tool()) replace(text, "RefCorrSys Base", "RefCorrSys Tool");
    // By way of signs that the text does not hold: the numbers may be exchanged.
    replace(text, "$OUT[101]", "$OUT[\1]");
    replace(text, "$OUT[102]", fmt::format("$OUT[{}]", v.release_output));
    replace(text, "$OUT[\1]", fmt::format("$OUT[{}]", v.path_output));
    return text;
}

}  // namespace

Expected<std::vector<ProgramFile>> write_rsi_program(const ProgramRequest& request) {
    SEAM_TRY(const auto values, read_values(request.settings));
    ProgramRequest measuring = request;
    measuring.driver.clear();
    measuring.settings = nlohmann::json::object();
    if (request.settings.contains("measuring") && request.settings["measuring"].is_object())
        measuring.settings = request.settings["measuring"].value("settings", nlohmann::json::object());
    auto files = write_kuka_program(measuring);
    if (!files) return files;
    const std::string name = values.relative() ? "SeamwrightRsiRelative" : "SeamwrightRsi";
    files->push_back({name + ".rsi", visual(values, name)});
    files->push_back({name + ".rsi.xml", context(values, name)});
    files->push_back({name + ".xml", ethernet(values)});
    files->push_back({"seamwright_rsi.src", program(values, name)});
    return files;
}

}  // namespace seamwright
