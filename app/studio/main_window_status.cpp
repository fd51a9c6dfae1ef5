// What the window says: the next step, the devices, the last push, troubles, who is signed in.

#include <QDateTime>
#include <QInputDialog>
#include <QKeyEvent>
#include <QLineEdit>
#include <QStatusBar>
#include <QStyle>
#include <algorithm>
#include <cmath>

#include "app/studio/dialogs/sign_in_dialog.h"
#include "app/studio/main_window.h"
#include "app/studio/page_area.h"
#include "app/studio/studio.h"
#include "widgets/into_view.h"
#include "widgets/menu_signs.h"
#include "widgets/pages/run_page.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

constexpr std::chrono::milliseconds kRobotStale{3000};
constexpr int kNextMargin_px = 64;  // icon and padding of the next-step button

// Broken at blanks, so that a button shows all of it.
QString wrapped(const QString& text, const QFontMetrics& font, int width_px) {
    QString out, line;
    for (const QString& word : text.split(' ')) {
        const QString longer = line.isEmpty() ? word : line + ' ' + word;
        if (!line.isEmpty() && font.horizontalAdvance(longer) > width_px) {
            out += line + '\n';
            line = word;
        } else {
            line = longer;
        }
    }
    return out + line;
}

}  // namespace

void MainWindow::make_status() {
    const auto label = [](const QString& name, const QString& tip) {
        auto* l = new QLabel;
        l->setObjectName(name);
        l->setToolTip(tip);
        l->setContentsMargins(8, 0, 8, 0);
        return l;
    };
    sensors_ = label("status_sensors", tr("Sensors: state, rate, dropped frames"));
    robots_ = label("status_robots", tr("Robots: mode and state"));
    push_ = label("status_push", tr("The last push"));
    events_ = label("status_events", tr("Alarms and refusals in the event log"));
    saved_ = label("status_saved", tr("Whether edits are saved"));
    person_ = label("status_person", tr("Who is signed in"));
    for (QLabel* l : {sensors_, robots_, push_, events_}) statusBar()->addWidget(l);
    statusBar()->addPermanentWidget(person_);
    statusBar()->addPermanentWidget(saved_);
    statusBar()->setSizeGripEnabled(false);
}

void MainWindow::refresh_next() {
    const auto say = [this](const QString& text) {
        next_->setText(wrapped(with_signs(text), next_->fontMetrics(), next_->width() - kNextMargin_px));
        next_->setMinimumHeight(std::max(style::kTargetPx, next_->sizeHint().height()));  // all its lines
        next_->setAccessibleName(text);
        next_->setToolTip(text);
    };
    // A calibration that is led through has the marked key itself.
    const bool led = !calibrating_.isEmpty() && !run_page_->asks();
    if (next_->property("quiet").toBool() != led) {
        next_->setProperty("quiet", led);
        next_->style()->unpolish(next_);
        next_->style()->polish(next_);
    }
    if (!desk_.is_open()) return say(tr("Open a project, or make a new one in the menu File"));
    if (push_waits()) return say(tr("A push waits for your answer: go to Run"));
    if (run_page_->asks()) return say(tr("Answer above: push, or do not push"));
    for (const StepState& s : desk_.steps()) {
        if (s.status != StepStatus::next) continue;
        if (!led) return say(tr("Next: %1 - %2").arg(step_name(s.step), s.why));
        return say(s.step == Step::calibrate ? calibrating_
                                             : tr("%1. Afterwards: %2").arg(calibrating_, step_name(s.step)));
    }
}

// What is not renewed is not called ok: a sensor by the age of its newest frame, a robot by the age of what it
// said last (a run asks it without telling here).
void MainWindow::refresh_devices() {
    QStringList sensors, robots;
    const auto seconds = [](auto age) {
        return static_cast<int>(std::chrono::duration_cast<std::chrono::seconds>(age).count());
    };
    for (const SensorState& s : desk_.station().sensors) {
        const QString id = QString::fromStdString(s.id);
        const auto old = desk_.live().age(s.id);
        if (old && *old > kStale)
            sensors << tr("sensor %1 no frame since %2 s").arg(id).arg(seconds(*old));
        else if (s.trouble.empty() && desk_.worker().busy() && !desk_.live().attached(s.id))
            sensors << tr("sensor %1 measures").arg(id);
        else if (!s.trouble.empty() || !old)
            sensors << tr("sensor %1 no frame").arg(id);
        else
            sensors << tr("sensor %1 ok %2 /s, %3 dropped")
                           .arg(id)
                           .arg(std::lround(desk_.live().rate_hz(s.id)))
                           .arg(s.counters.damaged + s.counters.underrun);
    }
    const auto asked = std::chrono::steady_clock::now() - desk_.station().asked;
    const bool old = asked > kRobotStale && !desk_.worker().busy();
    for (const RobotState& r : desk_.station().robots) {
        const QString id = QString::fromStdString(r.id);
        robots << (!r.trouble.empty() ? tr("robot %1 silent").arg(id)
                   : old              ? tr("robot %1 no answer since %2 s").arg(id).arg(seconds(asked))
                                      : tr("robot %1 %2 ok").arg(id, shown_word(to_string(r.mode))));
    }
    if (!desk_.station().connected) {
        sensors = {tr("not connected")};
        robots.clear();
    }
    sensors_->setText(sensors.join("   "));
    robots_->setText(robots.join("   "));
}

void MainWindow::refresh_status() {
    refresh_devices();
    QString push;
    if (const auto runs = desk_.runs())
        for (auto it = runs->rbegin(); it != runs->rend() && push.isEmpty(); ++it)
            if (it->push && it->status == RunStatus::ok)
                push = tr("last push %1, run %2 verified")
                           .arg(QDateTime::fromString(QString::fromStdString(it->finished_utc),
                                                      Qt::ISODateWithMs)
                                    .toLocalTime()
                                    .toString("HH:mm"))
                           .arg(it->number);
    push_->setText(push.isEmpty() ? tr("nothing pushed") : push);
}

void MainWindow::tell(const QString& sentence) {
    show_message(sentence, "alarm");
}

void MainWindow::tell_done(const QString& sentence) {
    show_message(sentence, "plain");
}

void MainWindow::show_message(const QString& sentence, const char* tone) {
    trouble_text_->setText(sentence);
    trouble_->setProperty("tone", tone);
    trouble_->setProperty("until_idle", false);
    trouble_->style()->unpolish(trouble_);
    trouble_->style()->polish(trouble_);
    place_message();
    trouble_->show();
    trouble_->raise();
    // What it is about has the focus.
    QWidget* field = QApplication::focusWidget();
    if (field && pages_->isAncestorOf(field) &&
        QRect(field->mapTo(centralWidget(), QPoint()), field->size()).intersects(trouble_->geometry()))
        bring_into_view(field);
}

void MainWindow::place_message() {
    constexpr int kEdge_px = 6;
    const int width = pages_->width() - 2 * kEdge_px;
    trouble_->ensurePolished();
    const int height = std::min(trouble_->heightForWidth(width), pages_->height());
    const QPoint lower_left = pages_->mapTo(centralWidget(), QPoint(kEdge_px, pages_->height() - kEdge_px));
    trouble_->setGeometry(lower_left.x(), lower_left.y() - height, width, height);
    for (PageArea* area : page_areas_) area->keep_free(std::min(height + kEdge_px, area->height() / 2));
}

void MainWindow::ask_who() {
    if (!desk_.asks_who())
        return tell(tr("The project has no users: nobody is asked. \"seamwright user add\" adds one."));
    if (findChild<SignInDialog*>()) return;
    auto* dialog = new SignInDialog(desk_, this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->open();
}

void MainWindow::refresh_person() {
    const auto& person = desk_.person();
    const bool asks = desk_.asks_who();
    person_->setVisible(asks);
    person_->setText(
        person ? QStringLiteral("%1, %2").arg(QString::fromStdString(person->name), role_name(person->role))
               : tr("nobody signed in"));
    sign_in_->setEnabled(asks);
    sign_out_->setEnabled(person.has_value());
    if (person && sign_out_minutes() > 0)
        idle_timer_.start(sign_out_minutes() * 60'000);
    else
        idle_timer_.stop();
}

int MainWindow::sign_out_minutes() const {
    return studio_.settings().value("sign_out_minutes", 10).toInt();
}

void MainWindow::set_sign_out() {
    bool given = false;
    const int minutes = QInputDialog::getInt(this, tr("Sign out by itself"),
                                             tr("Minutes without mouse and keyboard; 0: never"),
                                             sign_out_minutes(), 0, 24 * 60, 1, &given);
    if (!given) return;
    studio_.settings().setValue("sign_out_minutes", minutes);
    refresh_person();
}

bool MainWindow::eventFilter(QObject* object, QEvent* event) {
    switch (event->type()) {
        case QEvent::KeyPress:
        case QEvent::MouseButtonPress:
        case QEvent::MouseMove:
        case QEvent::Wheel:
            if (idle_timer_.isActive()) idle_timer_.start();
            break;
        case QEvent::Resize:
        case QEvent::Move:
            if (object == pages_ && trouble_->isVisible()) place_message();
            break;
        case QEvent::Hide:
            if (object == trouble_)
                for (PageArea* area : page_areas_) area->keep_free(0);
            break;
        case QEvent::ShortcutOverride:
            // A field in which nothing is being typed leaves undo and redo to the project.
            if (const auto* line = qobject_cast<QLineEdit*>(object); line && !line->isModified()) {
                const auto* key = static_cast<QKeyEvent*>(event);
                if (!key->matches(QKeySequence::Undo) && !key->matches(QKeySequence::Redo)) break;
                event->ignore();
                return true;
            }
            break;
        default:
            break;
    }
    return QMainWindow::eventFilter(object, event);
}

}  // namespace seamwright
