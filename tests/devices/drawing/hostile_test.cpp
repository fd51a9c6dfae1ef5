#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <random>

#include "devices/drawing/drawing.h"
#include "tests/devices/drawing/bodies.h"

namespace seamwright {
namespace {

Expected<Drawing> read_text(const std::string& text, const std::string& name) {
    return read_drawing(std::as_bytes(std::span(text.data(), text.size())), name);
}

void refused(const std::string& text, const std::string& name, const std::string& words) {
    const auto d = read_text(text, name);
    ASSERT_FALSE(d) << name << " " << words;
    EXPECT_EQ(d.error().kind, ErrorKind::file);
    EXPECT_NE(d.error().sentence().find(words), std::string::npos) << d.error().sentence();
}

TEST(HostileDrawing, EachEndsWithASentence) {
    const std::string box = box_step(10, 20, 30, 0);
    refused("", "a.step", "empty");
    refused("   \n", "a.step", "is no STEP file");
    refused("solid x\nendsolid x\n", "a.step", "is no STEP file");
    refused(std::string(1000, '\0'), "a.step", "is no STEP file");
    refused(box.substr(0, box.size() / 2), "a.step", "is cut off");
    refused(box, "a.iges", "is no IGES file");
    refused(box, "a.jt", "is neither");
    refused("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n", "a.step",
            "cannot be read");
    const std::string iges = box_iges(10, 20, 30);
    refused(iges.substr(0, iges.size() / 2), "a.igs", "is cut off");
    refused(box, "a.ply", "");
}

TEST(HostileDrawing, ASchemaWithoutShapesIsNamed) {
    const std::string text =
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
        "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n#1=IFCWALL('x',$,$,$,$,$,$,$);\nENDSEC;\nEND-ISO-10303-21;"
        "\n";
    const auto d = read_text(text, "house.step");
    ASSERT_FALSE(d);
    EXPECT_NE(d.error().sentence().find("IFC2X3"), std::string::npos) << d.error().sentence();
}

// What is left of a file after some of its bytes were turned, lines lost, numbers made huge, references led elsewhere:
// an answer or a sentence, never an end of the program.
TEST(HostileDrawing, DamagedFilesEndInAnAnswerOrASentence) {
    const std::string whole = box_step(100, 60, 30, 5);
    std::mt19937_64 random(7);
    const auto upto = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    int read_anyway = 0;
    for (int trial = 0; trial < 60; ++trial) {
        std::string text = whole;
        const std::size_t data = text.find("DATA;") + 6, end = text.rfind("ENDSEC");
        for (int k = 0; k < 1 + trial / 10; ++k) {
            const std::size_t at = data + upto(std::min(end, text.rfind("ENDSEC")) - data);
            switch (trial % 5) {
                case 0:
                    text[at] = static_cast<char>(random());
                    break;
                case 1:
                    text.erase(data + upto(text.rfind("ENDSEC") - data - 200), 100);
                    break;
                case 2:
                    text.insert(at, "1e308");
                    break;
                case 3:
                    if (const std::size_t ref = text.find('#', at); ref + 3 < text.rfind("ENDSEC"))
                        text.replace(ref + 1, 1, std::to_string(upto(400)));
                    break;
                default:
                    if (const std::size_t ref = text.find("(#", at); ref < text.rfind("ENDSEC"))
                        text.replace(ref, 2, "($,#");
            }
        }
        DrawingOptions options;
        options.patience_s = 2;  // some of them have no end
        if (const auto d =
                read_drawing(std::as_bytes(std::span(text.data(), text.size())), "damaged.step", options)) {
            ++read_anyway;
            EXPECT_FALSE(d->mesh.triangles.empty());
            for (const Eigen::Vector3d& v : d->mesh.vertices) EXPECT_TRUE(v.allFinite());
        } else {
            EXPECT_FALSE(d.error().sentence().empty());
        }
    }
    EXPECT_GT(read_anyway, 0);
}

TEST(HostileDrawing, OptionsOutOfRangeAndMissingFilesAreRefused) {
    DrawingOptions options;
    options.chord_mm = std::nan("");
    EXPECT_FALSE(read_drawing("x.step", options));
    options.chord_mm = 0;
    EXPECT_FALSE(read_drawing("x.step", options));
    EXPECT_FALSE(read_drawing("/nowhere/x.step"));
    EXPECT_FALSE(read_drawing("/nowhere/x.stl"));
}

TEST(HostileDrawing, ReadingSaysHowFarItIsAndCanBeCancelled) {
    const std::string text = plate_step(6, 6);
    DrawingOptions options;
    double last = 0;
    int calls = 0;
    options.progress = [&](double share, const Text&) {
        EXPECT_GE(share, last - 1e-9);
        EXPECT_LE(share, 1 + 1e-9);
        last = share;
        ++calls;
    };
    ASSERT_TRUE(read_drawing(std::as_bytes(std::span(text.data(), text.size())), "p.step", options));
    EXPECT_GT(calls, 5);
    for (const double until : {0.0, 0.3, 0.55, 0.7, 0.95}) {
        std::stop_source stop;
        DrawingOptions cancelled;
        cancelled.cancel = stop.get_token();
        cancelled.progress = [&](double share, const Text&) {
            if (share >= until) stop.request_stop();
        };
        const auto d = read_drawing(std::as_bytes(std::span(text.data(), text.size())), "p.step", cancelled);
        ASSERT_FALSE(d) << until;
        EXPECT_EQ(d.error().code, ErrorCode::cancelled) << d.error().sentence();
    }
}

}  // namespace
}  // namespace seamwright
