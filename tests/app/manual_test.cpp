// The manual speaks of the screen as it is: every name that it gives, link and picture is there, in both languages alike.
#include <gtest/gtest.h>

#include <QFile>
#include <QRegularExpression>
#include <QSet>
#include <QXmlStreamReader>
#include <nlohmann/json.hpp>

#include "app/manual/manual.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

QString plain(QString name) {
    static const QRegularExpression end(QStringLiteral("[ .:\\x{2026}]+$"));
    return name.remove('&').simplified().remove(end);
}

// Everything that the windows say, from the catalogues that translate them.
QSet<QString> names_on_the_screen(const QString& language) {
    const bool german = language == "de";
    QSet<QString> names;
    QFile windows(QStringLiteral(SEAMWRIGHT_TRANSLATIONS "/seamwright_de.ts"));
    EXPECT_TRUE(windows.open(QIODevice::ReadOnly));
    QXmlStreamReader xml(&windows);
    while (!xml.atEnd())
        if (xml.readNextStartElement() &&
            xml.name() == (german ? QLatin1String("translation") : QLatin1String("source")))
            names << plain(xml.readElementText(QXmlStreamReader::IncludeChildElements));
    QFile texts(QStringLiteral(SEAMWRIGHT_TRANSLATIONS "/texts_de.json"));
    EXPECT_TRUE(texts.open(QIODevice::ReadOnly));
    const auto catalogue = nlohmann::json::parse(texts.readAll().toStdString());
    for (const auto& [english, translated] : catalogue.items())
        if (translated.is_string())
            names << plain(QString::fromStdString(german ? translated.get<std::string>() : english));
    return names;
}

QStringList found(const QString& text, const char* pattern) {
    QStringList list;
    for (auto hit = QRegularExpression(QString::fromLatin1(pattern)).globalMatch(text); hit.hasNext();)
        list << hit.next().captured(1);
    return list;
}

class Manual : public testing::TestWithParam<const char*> {
  protected:
    QString language = GetParam();
};

TEST_P(Manual, NamesOnlyWhatIsOnTheScreen) {
    const QSet<QString> names = names_on_the_screen(language);
    ASSERT_GT(names.size(), 500);
    int checked = 0;
    for (const QString& page : manual_pages()) {
        const QString text = manual_text(page, language).simplified();
        for (const QString& named : found(text, "(?<!\\*)\\*(?!\\*)([^*]+)\\*(?!\\*)"))
            for (const QString& name : named.split(" > ")) {
                EXPECT_TRUE(names.contains(plain(name))) << qPrintable(page + ": " + name);
                ++checked;
            }
    }
    EXPECT_GT(checked, 40);
}

TEST_P(Manual, EveryStepHasItsPageUnderItsOwnNumber) {
    for (const Step step : kSteps) {
        const QString title = manual_title(manual_page_of(step), language);
        EXPECT_TRUE(title.startsWith(QString::number(static_cast<int>(step) + 1) + " ")) << qPrintable(title);
        EXPECT_TRUE(
            manual_text(manual_page_of(step), language).contains("(picture:" + manual_page_of(step) + ")"));
    }
}

TEST_P(Manual, LinksAndPicturesLeadSomewhere) {
    QSet<QString> pictures{"start"};
    for (const Step step : kSteps) pictures << manual_page_of(step);
    for (const QString& page : manual_pages()) {
        const QString text = manual_text(page, language);
        ASSERT_FALSE(text.isEmpty()) << qPrintable(page);
        for (const QString& to : found(text, "\\]\\(([a-z]+)\\.md\\)"))
            EXPECT_TRUE(manual_pages().contains(to));
        for (const QString& name : found(text, "\\(picture:([^)]*)\\)")) EXPECT_TRUE(pictures.contains(name));
        EXPECT_FALSE(without_pictures(text).contains("picture:")) << qPrintable(page);
    }
}

INSTANTIATE_TEST_SUITE_P(Languages, Manual, testing::Values("en", "de"));

TEST(ManualPages, BothLanguagesAreBuiltAlike) {
    for (const QString& page : manual_pages()) {
        const QString english = manual_text(page, "en"), german = manual_text(page, "de");
        for (const char* part : {"\n## ", "\n| ", "picture:", "\n1. ", "\n2. ", "\n3. "})
            EXPECT_EQ(english.count(part), german.count(part)) << qPrintable(page) << part;
        EXPECT_EQ(found(english, "`([a-z-]+) FILE").size(), found(german, "`([a-z-]+) DATEI").size())
            << qPrintable(page);
    }
    EXPECT_TRUE(manual_text("no such page", "en").isEmpty());
}

TEST(ManualPages, EveryCalibrationTitleThatIsTold) {
    const QString text = manual_text("calibrate", "en");
    int told = 0;
    for (const CalibrationMethod& m : calibration_methods())
        told += text.contains("*" + QString::fromStdString(m.title.english()) + "*") ? 1 : 0;
    EXPECT_GE(told, 7);
}

}  // namespace
}  // namespace seamwright
