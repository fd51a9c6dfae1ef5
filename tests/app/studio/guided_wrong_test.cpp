// A guided calibration with what people get wrong: files that are none, numbers that are none, keys in another order.

#include <QScrollBar>

#include "projects/calibrate/session/capture.h"
#include "tests/app/studio/guided.h"
#include "widgets/pages/guided/guided_page.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// The page of a method without devices, in the language of the window.
class GuidedWrong : public Guided {
  protected:
    void begin(const char* language = "en") {
        make_project();
        StudioOptions o = options();
        o.language = language;
        studio.emplace(*qApp, o);
        window().resize(1280, 800);
        window().show();
        me.emplace(window());
        me->step(2);
    }
    MainWindow& window() { return studio->window(); }
    CalibrationDesk& calibration() { return window().findChild<GuidedPage*>()->calibration(); }
    QString said() {
        auto* label = window().findChild<QLabel*>("calibration_said");
        return label && label->isVisible() ? label->text() : QString();
    }
    void load(const fs::path& path) {
        EXPECT_TRUE(me->wait([&] { return !calibration().busy(); }));  // of solving what was undone
        if (auto* label = window().findChild<QLabel*>("calibration_said")) label->hide();
        calibration().load(path);
        EXPECT_TRUE(me->wait([&] { return !calibration().busy(); }));
        QApplication::processEvents();
    }
    QStringList ids() {
        QStringList all;
        for (const SessionCapture& c : calibration().session().state().captures)
            all << QString::fromStdString(c.taken->id);
        return all;
    }
    fs::path write(const std::string& name, const std::string& text) const {
        const fs::path path = folder / name;
        std::ofstream(path) << text;
        return path;
    }
    std::optional<Studio> studio;
    std::optional<DeskPerson> me;
};

// The first number below that, wherever it stands.
json* first_number(json& in) {
    if (in.is_number()) return &in;
    if (in.is_structured())
        for (json& one : in)
            if (json* found = first_number(one)) return found;
    return nullptr;
}

struct WrongFile {
    std::string name, text;
    bool maybe_read = false;  // it may be taken, and is then solved or judged
};

std::vector<WrongFile> wrong_files(const CalibrationMethod& method) {
    const json good = method.example();
    std::vector<WrongFile> all{{"empty.json", ""},
                               {"list.json", "[1]"},
                               {"nothing.json", "{}"},
                               {"word.json", "abc"},
                               {"table.csv", "name;X;Y;Z;A;B;C\nP1;1,5;2;3;0;0;0\nP2;2,5;2;3;0;0;0\n"},
                               {"tabs.txt", "X\tY\tZ\n1\t2\t3\n"},
                               {"half.json", good.dump().substr(0, good.dump().size() / 2)}};
    const auto entries = good.find(method.entries);
    EXPECT_TRUE(entries != good.end() && entries->size() > 1) << method.id << ": its example has no list";
    if (entries == good.end() || entries->size() < 2) return all;
    const auto with = [&](const char* name, auto change, bool maybe_read = false) {
        json wrong = good;
        change(wrong[method.entries]);
        all.push_back({name, wrong.dump(), maybe_read});
    };
    with("none.json", [](json& list) { list = json::array(); });
    with(
        "one.json", [](json& list) { list = json::array({list[0]}); }, true);
    with(
        "twice.json", [](json& list) { list.push_back(list[0]); }, true);
    with("words.json", [](json& list) { list[1] = "abc"; });
    with("text_for_number.json", [](json& list) { *first_number(list[1]) = "abc"; });
    with("comma.json", [](json& list) { *first_number(list[1]) = "1,5"; });
    with("null.json", [](json& list) { *first_number(list[1]) = nullptr; });
    with(
        "huge.json", [](json& list) { *first_number(list[1]) = 1e300; }, true);
    {
        std::string text = good.dump();
        json marked = good;
        *first_number(marked[method.entries][1]) = "MARK";
        text = marked.dump();
        text.replace(text.find("\"MARK\""), 6, "NaN");
        all.push_back({"nan.json", text});
    }
    return all;
}

// Every method, every such file: one sentence says what is wrong, what was captured before stays, and the next key is there.
TEST_F(GuidedWrong, FilesAreRefusedInASentenceAndNothingIsLost) {
    for (const char* language : {"en", "de"}) {
        SCOPED_TRACE(language);
        fs::remove_all(folder);
        fs::create_directories(folder);
        begin(language);
        std::ofstream walk(fs::path(SEAMWRIGHT_SCREENS) / (std::string("wrong_files_") + language + ".txt"));
        for (const CalibrationMethod& method : calibration_methods()) {
            if (!method.guided) continue;
            SCOPED_TRACE(method.id);
            me->click("begin_" + QString::fromStdString(method.id));
            ASSERT_TRUE(calibration().is_open());
            const fs::path good = write("good.json", method.example().dump());
            load(good);
            walk << "\n== " << method.id << ": good: " << said().toStdString() << " (" << ids().size()
                 << ")\n";
            for (const WrongFile& wrong : wrong_files(method)) {
                SCOPED_TRACE(wrong.name);
                const QStringList before = ids();
                load(write(wrong.name, wrong.text));
                walk << wrong.name << ": " << said().toStdString() << " (" << ids().size() << ")\n";
                if (wrong.maybe_read) {  // what was taken of it is named where it does not serve, and undone
                    EXPECT_TRUE(!said().isEmpty() || ids() != before ||
                                method.capture == CaptureKind::board_chain);
                    while (calibration().undo_stack().canUndo() && ids() != before)
                        calibration().undo_stack().undo();
                    continue;
                }
                EXPECT_FALSE(said().isEmpty());
                EXPECT_EQ(ids(), before);
            }
            load(folder / "not_there.json");
            walk << "not there: " << said().toStdString() << "\n";
            EXPECT_FALSE(said().isEmpty());
            calibration().cancel();
            me->picture(QString("wrong_%1_%2").arg(QString::fromStdString(method.id), language));
            me->click("calibration_back");
        }
        me.reset();
        studio.reset();
    }
}

// Every field of every method, by keys.
TEST_F(GuidedWrong, FieldsRefuseInASentenceAndHoldTheDeedUp) {
    for (const char* language : {"en", "de"}) {
        SCOPED_TRACE(language);
        fs::remove_all(folder);
        fs::create_directories(folder);
        begin(language);
        std::ofstream walk(fs::path(SEAMWRIGHT_SCREENS) / (std::string("wrong_fields_") + language + ".txt"));
        for (const CalibrationMethod& method : calibration_methods()) {
            if (!method.guided) continue;
            SCOPED_TRACE(method.id);
            me->click("begin_" + QString::fromStdString(method.id));
            load(write("good.json", method.example().dump()));
            (void)me->wait([&] { return !calibration().busy(); });
            for (const MethodSetting& one : method.settings) {
                auto* editor =
                    me->find<ParameterEditor>("calibration_" + QString::fromStdString(one.info.name));
                if (!editor || !editor->findChild<QLineEdit*>()) continue;
                auto* line = editor->findChild<QLineEdit*>();
                for (const char* bad : {"abc", "NaN", "1e300", "-1", "0.03 m", "30 quux", "1,2,3", "1;2"}) {
                    const json before = calibration().session().state().settings;
                    me->write(line, bad);
                    walk << method.id << " " << one.info.name << " \"" << bad
                         << "\": " << editor->reason().toStdString() << "\n";
                    if (!editor->refused()) continue;
                    EXPECT_EQ(calibration().session().state().settings, before) << bad;
                    EXPECT_EQ(line->text(), bad);
                }
                me->write(line, "abc");
                ASSERT_TRUE(editor->refused());
                // Solving goes by the numbers: not by one that nobody sees.
                const auto solution = calibration().session().solution();
                if (auto* solve = window().findChild<QPushButton*>("calibration_solve");
                    solve->isVisible() && solve->isEnabled()) {
                    me->click("calibration_solve");
                    EXPECT_FALSE(said().isEmpty()) << one.info.name;
                    EXPECT_FALSE(calibration().busy());
                    EXPECT_FALSE(editor->visibleRegion().isEmpty()) << "the field is in sight";
                    EXPECT_EQ(calibration().session().solution(), solution);
                }
                QTest::keyClick(line, Qt::Key_Escape);
                EXPECT_FALSE(editor->refused());
                const double value = editor->value();
                me->write(line, QString::number(value) + " " + QString::fromStdString(one.info.unit));
                EXPECT_FALSE(editor->refused()) << editor->reason().toStdString();
            }
            calibration().cancel();
            me->click("calibration_back");
        }
        me.reset();
        studio.reset();
    }
}

}  // namespace
}  // namespace seamwright
