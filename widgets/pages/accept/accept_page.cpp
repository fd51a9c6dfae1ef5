#include "widgets/pages/accept/accept_page.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QHeaderView>

#include "devices/exchange/files.h"
#include "projects/measure/fields.h"
#include "widgets/into_view.h"
#include "widgets/print/pdf.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

// Share of the tolerance and standard deviations that companies put into Cg.
constexpr std::array<std::pair<double, double>, 4> kVariants{{{0.2, 6}, {0.2, 4}, {0.15, 6}, {0.15, 4}}};

// A row that can be hidden as a whole.
QWidget* row_of(QVBoxLayout& box, const QString& label, QWidget* field, const QString& tip) {
    auto* holder = new QWidget;
    auto* inner = new QVBoxLayout(holder);
    inner->setContentsMargins(0, 0, 0, 0);
    add_field(*inner, label, field, tip);
    box.addWidget(holder);
    return holder;
}

}  // namespace

AcceptPage::AcceptPage(Desk& desk, const Views& views)
    : StepPage(desk, views, Step::accept,
               tr("Is the measuring process good enough for the tolerance? Each study of the release, as "
                  "AIAG MSA, "
                  "VDA 5 and ISO 22514-7 ask for it, of the bead's deviation across its path.")),
      acceptance_(desk) {
    make_fixed_head();
    make_studies();
    make_requirements();
    make_offsets();
    make_exports();
    box().addStretch(1);
    connect(&acceptance_, &AcceptanceDesk::judged, this, [this] {
        if (isVisible()) refresh();
    });
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (isVisible()) enable();
    });
    connect(&desk_.worker(), &StationWorker::busy_changed, this, [this](bool busy) {
        if (!busy) place_->hide();
        if (isVisible()) refresh();
    });
    connect(&desk_.worker(), &StationWorker::place_study_part, this, [this](const QString& part, int rehang) {
        place_text_->setText(tr("Put in part %1, time %2").arg(part).arg(rehang));
        place_->show();
    });
    connect(&desk_.worker(), &StationWorker::studied, this,
            [this](const std::shared_ptr<const StudyProgress>& progress) {
                if (!progress->stopped.empty()) emit told(shown(progress->stopped));
            });
    connect(&desk_, &Desk::opened, this, [this] { filled_.reset(); });
}

void AcceptPage::make_fixed_head() {
    QVBoxLayout& head = make_head();
    region_ = new QComboBox;
    region_->setObjectName("accept_region");
    add_field(head, tr("Region"), region_, tr("The region whose measuring process is studied"));
    connect(region_, &QComboBox::textActivated, this,
            [this](const QString& id) { desk_.selection().select_region(id.toStdString()); });
    tolerance_ = make_text({});
    tolerance_->setObjectName("accept_tolerance");
    head.addWidget(tolerance_);
    verdict_ = make_text({});
    verdict_->setObjectName("accept_verdict");
    head.addWidget(verdict_);
    next_ = make_button("accept_next", "next", tr("Next"), tr("What comes next in the acceptance"), [this] {
        const Agenda* agenda = acceptance_.agenda();
        if (!agenda) return;
        if (desk_.project().requirements.acceptance.tolerance_mm == 0) {
            bring_into_view(requirements_.front());
            return requirements_.front()->setFocus();
        }
        if (!agenda->next) return write_report();
        choose(*agenda->next);
        do_deed(agenda->of(*agenda->next), false);
    });
    head.addWidget(next_);
    head.addWidget(make_progress());
    place_ = new QFrame;
    place_->setObjectName("place_study_part");
    place_->setFrameShape(QFrame::StyledPanel);
    auto* place_box = new QVBoxLayout(place_);
    place_text_ = make_text({});
    place_text_->setObjectName("place_study_text");
    place_box->addWidget(place_text_);
    const auto answer = [this](bool yes) {
        place_->hide();
        desk_.worker().answer_push(yes);
    };
    place_box->addLayout(make_row({make_button("study_placed", "check", tr("It stands"),
                                               tr("Measure this part"), [answer] { answer(true); }),
                                   make_button("study_later", "stop", tr("Later"),
                                               tr("The study waits; it goes on from here another time"),
                                               [answer] { answer(false); })}));
    place_->hide();
    head.addWidget(place_);
}

QSpinBox* AcceptPage::count(const QString& name, int least, int most) {
    auto* box = new QSpinBox;
    box->setObjectName(name);
    box->setRange(least, most);
    return box;
}

void AcceptPage::make_studies() {
    box().addWidget(make_heading(tr("Studies")));
    list_ = make_table("studies", {tr("Study"), tr("State"), tr("Verdict")},
                       tr("Every study, how far it is and what came of it"));
    list_->setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    list_->setRowCount(static_cast<int>(kAgenda.size()));
    list_->setCurrentCell(static_cast<int>(AgendaStudy::type1), 0);
    connect(list_, &QTableWidget::currentCellChanged, this, [this] {
        refresh_study();
        draw();
    });
    box().addWidget(list_);
    name_ = make_heading({});
    name_->setObjectName("study_name");
    box().addWidget(name_);
    needs_ = make_text({});
    needs_->setObjectName("study_needs");
    box().addWidget(needs_);
    finding_ = make_text({});
    finding_->setObjectName("study_finding");
    box().addWidget(finding_);
    runs_ = count("study_runs", 1, kMostStudyRuns);
    runs_row_ =
        row_of(box(), tr("Runs"), runs_, tr("How often each part is measured, each time it is put in"));
    rehangs_ = count("study_rehangs", 1, kMostRehangs);
    rehangs_row_ = row_of(box(), tr("Put in"), rehangs_, tr("How often each part is put in"));
    parts_ = new QLineEdit;
    parts_->setObjectName("study_parts");
    parts_row_ =
        row_of(box(), tr("Parts"), parts_, tr("Names of the parts, separated by commas, in their order"));
    travel_ = count("study_travel", -90, 90);
    travel_->setValue(45);
    travel_->setSuffix(tr(" deg"));
    travel_row_ =
        row_of(box(), tr("Travel turned by"), travel_,
               tr("From the sensor's Y towards its X, so that the pass crosses the contour; the way must "
                  "be free"));
    deed_ = make_button("study_deed", "play", tr("Measure"), tr("Measures; nothing is written to the robot"),
                        [this] {
                            if (const AgendaItem* at = item()) do_deed(*at, true);
                        });
    anew_ =
        make_button("study_anew", "redo", tr("Begin anew"),
                    tr("Measures the whole study again, whatever was measured; the old runs stay"), [this] {
                        const AgendaItem* at = item();
                        if (!at) return;
                        LiveStudyOptions options = options_of(*at, true);
                        options.anew = true;
                        desk_.worker().measure_study(options);
                    });
    charts_ = make_button("study_charts", "window", tr("In the charts"),
                          tr("Run chart, and histogram with the tolerance, in the charts beside"), [this] {
                              draw();
                              views_.raise(views_.trend);
                          });
    box().addLayout(make_row({deed_, anew_, charts_}));
    for (QLabel** label : {&result_, &forecast_}) {
        *label = make_text({});
        (*label)->setTextFormat(Qt::RichText);
        box().addWidget(*label);
    }
    result_->setObjectName("study_result");
    forecast_->setObjectName("study_forecast");
}

void AcceptPage::make_requirements() {
    box().addWidget(make_heading(tr("Requirements")));
    box().addWidget(
        make_text(tr("The customer's. They are kept in the project, and no run depends on them.")));
    const QStringList names{tr("Tolerance T"),       tr("Middle of the tolerance"),
                            tr("Share of T in Cg"),  tr("Sigmas in Cg"),
                            tr("Cg, at least"),      tr("Cgk, at least"),
                            tr("%GRR accepted"),     tr("%GRR refused beyond"),
                            tr("ndc, at least"),     tr("Q system, at most"),
                            tr("Q process, at most")};
    for (const Field<AcceptanceRequirements>& f : acceptance_fields()) {
        auto* editor = new ParameterEditor(f.info);
        editor->set_name(names.value(static_cast<qsizetype>(requirements_.size())));
        connect(editor, &ParameterEditor::committed, this, [this, set = f.set](double value) {
            AcceptanceRequirements after = desk_.project().requirements.acceptance;
            set(after, value);
            if (!done(desk_.edit_acceptance(after))) refresh_requirements();
        });
        box().addWidget(editor);
        requirements_.push_back(editor);
    }
    variant_ = new QComboBox;
    variant_->setObjectName("cg_variant");
    for (const auto& [share, width] : kVariants)
        variant_->addItem(tr("Cg = %1 T / (%2 s)").arg(share).arg(width));
    variant_->addItem(tr("another, as above"));
    add_field(box(), tr("Variant of Cg"), variant_,
              tr("Share of the tolerance and sigmas as the company asks for"));
    connect(variant_, &QComboBox::activated, this, [this](int at) {
        if (at < 0 || at >= static_cast<int>(kVariants.size())) return refresh_requirements();
        AcceptanceRequirements after = desk_.project().requirements.acceptance;
        std::tie(after.cg_share, after.cg_width) = kVariants[static_cast<std::size_t>(at)];
        done(desk_.edit_acceptance(after));
    });
}

void AcceptPage::make_offsets() {
    box().addWidget(make_heading(tr("Kept offsets")));
    box().addWidget(make_text(
        tr("An offset against a better instrument acts on every run of the region from the moment it is "
           "switched on, and every run says so. Undo takes the switch back.")));
    offsets_ = make_table("offsets", {tr("Version"), tr("State"), tr("X Y Z mm"), tr("From")},
                          tr("Offsets kept of correlations, and which one acts"));
    offsets_->setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    connect(offsets_, &QTableWidget::currentCellChanged, this, [this] { enable(); });
    box().addWidget(offsets_);
    keep_ = make_button("keep_offset", "add", tr("Keep the offset found"),
                        tr("The correlation's offset as a new version; it does not act yet"), [this] {
                            if (auto kept = acceptance_.keep_offset(); !kept)
                                emit desk_.trouble(shown_error(kept.error()));
                            else
                                emit told(tr("Kept as version %1; it does not act yet").arg(*kept));
                        });
    act_ = make_button("offset_on", "check", tr("Let it act"),
                       tr("This version acts on every run from here on"), [this] {
                           const auto* version = offsets_->item(offsets_->currentRow(), 0);
                           if (version) done(acceptance_.switch_offset(version->text().toInt()));
                       });
    off_ = make_button("offset_off", "stop", tr("None acts"), tr("No offset acts from here on"),
                       [this] { done(acceptance_.switch_offset(0)); });
    box().addLayout(make_row({keep_, act_, off_}));
}

void AcceptPage::make_exports() {
    box().addWidget(make_heading(tr("Report")));
    language_ = new QComboBox;
    language_->setObjectName("report_language");
    language_->addItem(tr("English"), static_cast<int>(Language::english));
    language_->addItem(tr("German"), static_cast<int>(Language::german));
    language_->setCurrentIndex(desk_.language() == Language::german ? 1 : 0);
    add_field(box(), tr("Language"), language_, tr("Of the report"));
    report_ = make_button("accept_report", "export", tr("Report..."), tr("PDF or HTML, with lines to sign"),
                          [this] { write_report(); });
    values_ = make_button("accept_values", "export", tr("Values..."),
                          tr("The values as Q-DAS ASCII (.dfq) or as an Excel workbook (.xlsx)"),
                          [this] { write_values(); });
    box().addLayout(make_row({report_, values_}));
}

void AcceptPage::do_deed(const AgendaItem& at, bool with_fields) {
    switch (at.study) {
        case AgendaStudy::robot:
            return desk_.worker().measure_robot({});
        case AgendaStudy::trigger: {
            MeasureTriggerOptions options;
            options.travel_deg = travel_->value();
            return desk_.worker().measure_trigger(options);
        }
        case AgendaStudy::sensor:
        case AgendaStudy::correlation:
            return import(at.study);
        case AgendaStudy::linearity:
            return emit step_wanted(Step::prove);
        case AgendaStudy::vda5:
            return;
        default:
            desk_.worker().measure_study(options_of(at, with_fields));
    }
}

LiveStudyOptions AcceptPage::options_of(const AgendaItem& at, bool with_fields) const {
    LiveStudyOptions options = at.proposed;
    if (!with_fields) return options;
    options.runs = runs_->value();
    if (at.study != AgendaStudy::type3) return options;
    options.rehangs = rehangs_->value();
    options.parts.clear();
    for (const QString& part : parts_->text().split(',', Qt::SkipEmptyParts))
        options.parts.push_back(part.trimmed().toStdString());
    return options;
}

void AcceptPage::import(AgendaStudy study) {
    const bool sensor = study == AgendaStudy::sensor;
    const QString file = QFileDialog::getOpenFileName(
        this,
        sensor ? tr("The artefact's certificate and points") : tr("Parts measured by the other instrument"),
        QFileInfo(QString::fromStdString(desk_.path().string())).path(),
        sensor ? tr("JSON (*.json)") : tr("CSV (*.csv)"));
    if (file.isEmpty()) return;
    done(sensor ? acceptance_.import_sensor_data(file.toStdString())
                : acceptance_.import_references(file.toStdString()));
}

void AcceptPage::write_report() {
    const auto language = static_cast<Language>(language_->currentData().toInt());
    auto page = acceptance_.page(language);
    if (!page) return emit desk_.trouble(shown_error(page.error()));
    const QFileInfo project(QString::fromStdString(desk_.path().string()));
    const QString file = QFileDialog::getSaveFileName(
        this, tr("Acceptance report"), project.path() + "/" + project.completeBaseName() + "_acceptance.pdf",
        tr("PDF (*.pdf);;HTML (*.html)"));
    if (file.isEmpty()) return;
    const auto written = file.endsWith(".html", Qt::CaseInsensitive)
                             ? write_text_file(file.toStdString(), page->html())
                             : write_pdf(*page, file.toStdString());
    if (done(written)) emit told(tr("The report is in %1").arg(file));
}

void AcceptPage::write_values() {
    const QFileInfo project(QString::fromStdString(desk_.path().string()));
    const QString file = QFileDialog::getSaveFileName(
        this, tr("Values"), project.path() + "/" + project.completeBaseName() + ".dfq",
        tr("Q-DAS (*.dfq);;Excel (*.xlsx)"));
    if (file.isEmpty()) return;
    if (done(acceptance_.write_values(file.toStdString(),
                                      static_cast<Language>(language_->currentData().toInt()))))
        emit told(tr("The values are in %1").arg(file));
}

}  // namespace seamwright
