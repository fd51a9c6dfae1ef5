// Widget tests need a screen: without one they start themselves again inside Xvfb.
#include <gtest/gtest.h>
#include <unistd.h>

#include <QApplication>
#include <cstdlib>
#include <string>
#include <vector>

#include "widgets/style.h"

int main(int argc, char** argv) {
    bool listing = false;
    for (int i = 1; i < argc; ++i) listing = listing || std::string(argv[i]) == "--gtest_list_tests";
    if (!listing && !std::getenv("DISPLAY") && !std::getenv("SEAMWRIGHT_NO_XVFB")) {
        setenv("SEAMWRIGHT_NO_XVFB", "1", 1);
        std::vector<char*> words;
        const char* screen = std::getenv("QT_SCALE_FACTOR") ? "-screen 0 3200x2000x24 +extension GLX"
                                                            : "-screen 0 1600x1000x24 +extension GLX";
        for (const char* word : {"xvfb-run", "-a", "-s", screen}) words.push_back(const_cast<char*>(word));
        for (int i = 0; i < argc; ++i) words.push_back(argv[i]);
        words.push_back(nullptr);
        execvp(words[0], words.data());
        setenv("QT_QPA_PLATFORM", "offscreen", 1);  // no Xvfb either: all but OpenGL
    }
    testing::InitGoogleTest(&argc, argv);
    if (listing) return RUN_ALL_TESTS();
    QApplication application(argc, argv);
    QApplication::setStyle("Fusion");
    application.setFont(QFont("DejaVu Sans", seamwright::style::kTextPt));
    return RUN_ALL_TESTS();
}
