#include "widgets/pages/parts/spot_light_panel.h"

#include <QVBoxLayout>

#include "projects/measure/measure.h"
#include "widgets/pages/parts/form.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

QString settings_words(const ParameterValues& settings) {
    QStringList parts;
    for (const auto& [identifier, value] : settings) {
        const auto [name, unit] = shown_setting(identifier);
        parts << QStringLiteral("%1 %2 %3").arg(name, QString::number(value, 'g', 6), unit).trimmed();
    }
    return parts.join(QStringLiteral(", "));
}

}  // namespace

QString light_words(const SpotLight& light) {
    QStringList parts;
    if (!light.settings.empty()) parts << settings_words(light.settings);
    if (!light.merge_us.empty()) {
        QStringList exposures;
        for (const double us : light.merge_us) exposures << QString::number(us, 'f', 0);
        parts << SpotLightPanel::tr("merged from %1 µs").arg(exposures.join(QStringLiteral(", ")));
    }
    if (light.follows_paint())
        parts << SpotLightPanel::tr("follows the paint, %1 to %2 µs")
                     .arg(QString::number(light.shortest_us, 'f', 0),
                          QString::number(light.longest_us, 'f', 0));
    for (const PaintLight& p : light.paints)
        parts << SpotLightPanel::tr("paint %1: %2")
                     .arg(QString::fromStdString(p.paint), settings_words(p.settings));
    return parts.isEmpty() ? SpotLightPanel::tr("As the sensor stands.") : parts.join(QStringLiteral("; "));
}

SpotLightPanel::SpotLightPanel(Desk& desk, QWidget* parent) : QWidget(parent), desk_(desk) {
    auto* in = new QVBoxLayout(this);
    in->setContentsMargins(0, 0, 0, 0);
    in->addWidget(make_heading(tr("Light")));
    now_ = make_text({});
    now_->setObjectName("spot_light");
    in->addWidget(now_);
    find_ =
        make_button("find_light", "search", tr("Find light"),
                    tr("The robot stands at the spot; exposure and gain are found from the stripe"), [this] {
                        if (const Spot* s = find_spot(desk_.project(), spot_id_))
                            desk_.worker().find_light(*s);
                    });
    clear_ = make_button("clear_light", "remove", tr("As the sensor"),
                         tr("The spot sets nothing of its own any more; undo brings it back"), [this] {
                             const Spot* s = find_spot(desk_.project(), spot_id_);
                             if (!s) return;
                             Spot after = *s;
                             after.light = {};
                             edit(after, tr("light"));
                         });
    in->addLayout(make_row({find_, clear_}));
    said_ = make_text({});
    said_->setObjectName("light_found");
    in->addWidget(said_);
    connect(&desk_.worker(), &StationWorker::light_found, this,
            [this](const std::shared_ptr<const LightOfSpot>& found) { take(found->spot, found->light); });
    connect(&desk_, &Desk::station_changed, this,
            [this] { find_->setEnabled(desk_.station().connected && !spot_id_.empty()); });
}

void SpotLightPanel::refresh(const Spot* spot) {
    const std::string id = spot ? spot->id : std::string();
    if (id != spot_id_) said_->clear();
    spot_id_ = id;
    now_->setText(spot ? light_words(spot->light) : QString());
    find_->setEnabled(spot && desk_.station().connected);
    clear_->setEnabled(spot && !spot->light.empty());
}

void SpotLightPanel::edit(const Spot& after, const QString& what) {
    if (const auto done = desk_.edit(after, what); !done) emit refused(done.error());
}

void SpotLightPanel::take(const Spot& asked, const FoundLight& found) {
    const Spot* s = find_spot(desk_.project(), asked.id);
    if (!s) return;
    const bool shown = asked.id == spot_id_;
    const int frames = static_cast<int>(found.tried.size());
    switch (found.verdict) {
        case LightVerdict::fit:
            break;
        case LightVerdict::too_dark:
            if (shown)
                said_->setText(tr("Too dark even at %1 µs: open the aperture, or stand still at the trigger.")
                                   .arg(QString::number(found.longest_us, 'f', 0)));
            return;
        case LightVerdict::too_bright:
            if (shown) said_->setText(tr("Too bright even at the shortest exposure: close the aperture."));
            return;
        case LightVerdict::no_stripe:
            if (shown)
                said_->setText(
                    tr("No stripe was seen (frames: %1): is the laser on, the part there?").arg(frames));
            return;
    }
    Spot after = *s;
    for (const auto& [name, value] : found.settings) after.light.settings[name] = value;
    after.light.merge_us = found.merge_us;
    if (!found.merge_us.empty()) after.light.shortest_us = after.light.longest_us = 0;
    edit(after, tr("light"));
    if (!shown) return;
    QString said = tr("Found (frames: %1).").arg(frames);
    if (found.merge_us.empty() && found.unserved_share > 0.03)
        said += QStringLiteral(" ") +
                tr("%1 % of the lines stay dark; where the robot stands still, several exposures are merged.")
                    .arg(QString::number(100 * found.unserved_share, 'f', 0));
    said_->setText(said);
}

}  // namespace seamwright
