// What is delivered for RSI: well-formed, and context, configuration of ETHERNET and program agree.

#include <gtest/gtest.h>

#include <map>
#include <pugixml.hpp>
#include <set>

#include "devices/kuka/program.h"

namespace seamwright {
namespace {

struct Delivered {
    std::map<std::string, std::string> files;
    pugi::xml_document context, visual, ethernet;
    std::string program, name;
};

void deliver(const nlohmann::json& settings, const std::string& name, Delivered& d) {
    ProgramRequest request;
    request.project = "door";
    request.driver = "kuka-rsi";
    request.settings = settings;
    MeasuringMove move;
    move.spot_id = "S1";
    move.entry = move.trigger = move.exit = make_pose(Eigen::Matrix3d::Identity(), {800, 0, 500});
    request.moves = {move};
    const auto files = write_kuka_program(request);
    ASSERT_TRUE(files) << files.error().sentence();
    for (const ProgramFile& f : *files) d.files[f.name] = f.text;
    d.name = name;
    for (const char* ending : {".rsi", ".rsi.xml", ".xml"})
        ASSERT_TRUE(d.files.count(name + ending)) << name << ending;
    ASSERT_TRUE(d.files.count("seamwright_rsi.src"));
    ASSERT_TRUE(d.context.load_string(d.files[name + ".rsi.xml"].c_str()));
    ASSERT_TRUE(d.visual.load_string(d.files[name + ".rsi"].c_str()));
    ASSERT_TRUE(d.ethernet.load_string(d.files[name + ".xml"].c_str()));
    d.program = d.files["seamwright_rsi.src"];
}

pugi::xml_node object(const Delivered& d, const char* type) {
    return d.context.child("RSIObjects").find_child_by_attribute("RSIObject", "ObjType", type);
}
std::string parameter(const pugi::xml_node& object, const char* name) {
    return object.child("Parameters")
        .find_child_by_attribute("Parameter", "Name", name)
        .attribute("ParamValue")
        .value();
}
pugi::xml_node element(const Delivered& d, const char* way, const std::string& tag) {
    return d.ethernet.child("ROOT")
        .child(way)
        .child("ELEMENTS")
        .find_child_by_attribute("ELEMENT", "TAG", tag.c_str());
}

class RsiFiles : public testing::TestWithParam<bool> {};

TEST_P(RsiFiles, ContextConfigurationAndProgramAgree) {
    const bool relative = GetParam();
    Delivered d;
    deliver(
        {{"listen", "192.168.1.7"},
         {"port", 50001},
         {"mode", relative ? "relative" : "absolute"},
         {"sen_type", "Seam"},
         {"max_translation_mm", 6.5},
         {"max_rotation_deg", 1.25},
         {"path_output", 102},
         {"release_output", 101},
         {"measuring", {{"driver", "kuka-eki"}, {"settings", {{"listen", "192.168.1.8"}, {"port", 54601}}}}}},
        relative ? "SeamwrightRsiRelative" : "SeamwrightRsi", d);
    if (HasFatalFailure()) return;
    // The program loads the context, the context the configuration.
    EXPECT_NE(d.program.find("RSI_CREATE(\"" + d.name + ".rsi\""), std::string::npos);
    EXPECT_NE(d.program.find(relative ? "RSI_ON(#RELATIVE)" : "RSI_ON(#ABSOLUTE)"), std::string::npos);
    const pugi::xml_node ethernet = object(d, "ETHERNET"), corr = object(d, "POSCORR");
    EXPECT_EQ(parameter(ethernet, "ConfigFile"), d.name + ".xml");
    const pugi::xml_node config = d.ethernet.child("ROOT").child("CONFIG");
    EXPECT_STREQ(config.child("IP_NUMBER").text().get(), "192.168.1.7");
    EXPECT_STREQ(config.child("PORT").text().get(), "50001");
    EXPECT_STREQ(config.child("SENTYPE").text().get(), "Seam");
    // Each RKorr goes to the input of POSCORR of its axis.
    int axis = 0;
    for (const char* tag : {"RKorr.X", "RKorr.Y", "RKorr.Z", "RKorr.A", "RKorr.B", "RKorr.C"}) {
        const pugi::xml_node e = element(d, "RECEIVE", tag);
        EXPECT_STREQ(e.attribute("HOLDON").value(), relative ? "0" : "1") << tag;
        const pugi::xml_node in =
            corr.child("Inputs").find_child_by_attribute("Input", "InIdx", std::to_string(++axis).c_str());
        EXPECT_EQ(std::string(in.attribute("OutObjID").value()), ethernet.attribute("ObjID").value());
        EXPECT_STREQ(in.attribute("OutIdx").value(), e.attribute("INDX").value()) << tag;
    }
    // What the driver cannot do without.
    for (const char* tag : {"DEF_RIst", "DEF_RSol", "DEF_Delay"})
        EXPECT_STREQ(element(d, "SEND", tag).attribute("INDX").value(), "INTERNAL") << tag;
    // The two outputs.
    const pugi::xml_node path = object(d, "DIGOUT"), release = object(d, "MAP2DIGOUT");
    EXPECT_EQ(parameter(path, "Index"), "102");
    EXPECT_EQ(parameter(release, "Index"), "101");
    EXPECT_NE(d.program.find("WAIT FOR $OUT[101]"), std::string::npos);
    EXPECT_NE(d.program.find("$OUT[102]=TRUE"), std::string::npos);
    EXPECT_NE(d.program.find("WHEN $OUT[101]==FALSE"), std::string::npos);
    EXPECT_STREQ(element(d, "RECEIVE", "Release").attribute("HOLDON").value(), "1")
        << "a late answer is no release that falls";
    EXPECT_STREQ(ethernet.child("Inputs").child("Input").attribute("OutObjID").value(),
                 path.attribute("ObjID").value());
    EXPECT_STREQ(ethernet.child("Inputs").child("Input").attribute("InIdx").value(),
                 element(d, "SEND", "Path").attribute("INDX").value());
    EXPECT_STREQ(release.child("Inputs").child("Input").attribute("OutIdx").value(),
                 element(d, "RECEIVE", "Release").attribute("INDX").value());
    // Limits.
    for (const char* limit : {"LowerLimX", "LowerLimY", "LowerLimZ"})
        EXPECT_EQ(parameter(corr, limit), "-6.5");
    for (const char* limit : {"UpperLimX", "UpperLimY", "UpperLimZ"})
        EXPECT_EQ(parameter(corr, limit), "6.5");
    EXPECT_EQ(parameter(corr, "MaxRotAngle"), "1.25");
    EXPECT_EQ(parameter(corr, "RefCorrSys"), "1");
    EXPECT_EQ(parameter(object(d, "POSCORRMON"), "MaxTrans"), "6.5");
    // The measuring link is another connection.
    EXPECT_NE(d.files["Seamwright.xml"].find("192.168.1.8"), std::string::npos);
    EXPECT_NE(d.files["Seamwright.xml"].find("54601"), std::string::npos);
}

// RSI Visual's file and the one that the controller loads are the same signal flow.
TEST_P(RsiFiles, RsiVisualDrawsTheSame) {
    Delivered d;
    deliver({{"mode", GetParam() ? "relative" : "absolute"}, {"max_translation_mm", 3}},
            GetParam() ? "SeamwrightRsiRelative" : "SeamwrightRsi", d);
    if (HasFatalFailure()) return;
    std::set<std::string> ids;
    for (const pugi::xml_node o : d.context.child("RSIObjects").children("RSIObject")) {
        const std::string id = o.attribute("ObjID").value();
        EXPECT_TRUE(ids.insert(id).second) << id;
        const pugi::xml_node drawn = d.visual.child("rSIModel")
                                         .child("rSIObjects")
                                         .find_child_by_attribute("rSIElement", "name", id.c_str());
        ASSERT_TRUE(drawn) << id;
        EXPECT_STREQ(drawn.attribute("objType").value(), o.attribute("ObjType").value());
        EXPECT_STREQ(drawn.attribute("objTypeID").value(), o.attribute("ObjTypeID").value());
        for (const pugi::xml_node p : o.child("Parameters").children("Parameter")) {
            const pugi::xml_node q =
                drawn.child("rSIParameters")
                    .find_child_by_attribute("rSIParameter", "name", p.attribute("Name").value());
            ASSERT_TRUE(q) << id << " " << p.attribute("Name").value();
            EXPECT_STREQ(q.attribute("index").value(), p.attribute("ParamID").value());
            if (std::string(q.attribute("isEnum").value()) == "false") {
                EXPECT_STREQ(q.attribute("value").value(), p.attribute("ParamValue").value());
            }
        }
        std::size_t inputs = 0;
        for (const pugi::xml_node port : drawn.child("rSIInPorts").children("rSIInPort")) {
            const std::string from =
                port.child("source").child("rSIOutPortMoniker").attribute("name").value();
            auto in = o.child("Inputs").first_child();
            for (std::size_t i = 0; i < inputs; ++i) in = in.next_sibling();
            EXPECT_EQ(from, "//" + std::string(in.attribute("OutObjID").value()) + "/Out" +
                                in.attribute("OutIdx").value());
            ++inputs;
        }
        const auto all = o.child("Inputs").children("Input");
        EXPECT_EQ(inputs, static_cast<std::size_t>(std::distance(all.begin(), all.end()))) << id;
    }
}
INSTANTIATE_TEST_SUITE_P(AbsoluteAndRelative, RsiFiles, testing::Bool());

}  // namespace
}  // namespace seamwright
