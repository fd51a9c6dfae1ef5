#include "projects/acceptance/pages/acceptance_workbook.h"

#include "projects/acceptance/pages/acceptance_page.h"

namespace seamwright {
namespace {

class Indices {
  public:
    explicit Indices(Language language) : language_(language) {
        sheet.name = word("Studies");
        sheet.rows.push_back({word("Study"), word("Index"), word("unit"), word("Value"), std::string("2.5 %"),
                              std::string("97.5 %"), word("Required"), word("Verdict")});
    }
    // The lines until the next begin are of this study.
    void begin(Study study, AcceptanceVerdict verdict) {
        study_ = title_of(study).in(language_);
        verdict_ = name_of(verdict).in(language_);
    }
    void add(const char* index, const char* unit, double value, std::optional<Interval> limits = {},
             std::optional<double> required = {}) {
        sheet.rows.push_back({study_, std::string(index), std::string(unit), value,
                              limits ? Cell(limits->low) : Cell(), limits ? Cell(limits->high) : Cell(),
                              required ? Cell(*required) : Cell(), verdict_});
    }
    std::string word(const char* english) const { return Text::chosen(english).in(language_); }
    Sheet sheet;

  private:
    Language language_;
    std::string study_, verdict_;
};

void add_indices(Indices& to, const Acceptance& a) {
    const AcceptanceSettings& s = a.settings;
    if (a.type1) {
        to.begin(Study::type1, a.type1->verdict);
        to.add("n", "", a.type1->n);
        to.add("mean", "mm", a.type1->mean_mm, a.type1->mean_limits);
        to.add("s", "mm", a.type1->s_mm, a.type1->s_limits);
        to.add("bias", "mm", a.type1->bias_mm, a.type1->bias_limits);
        to.add("Cg", "", a.type1->cg, a.type1->cg_limits, s.required);
        to.add("Cgk", "", a.type1->cgk, a.type1->cgk_limits, s.required_cgk.value_or(s.required));
    }
    if (a.type3) {
        to.begin(Study::type3, a.type3->verdict);
        to.add("EV", "mm", a.type3->ev_mm, a.type3->ev_limits);
        if (a.type3->nested) to.add("rehang", "mm", a.type3->rehang_mm, a.type3->rehang_limits);
        to.add("GRR", "mm", a.type3->grr_mm, a.type3->grr_limits);
        to.add("PV", "mm", a.type3->pv_mm, a.type3->pv_limits);
        to.add("%GRR", "%", a.type3->grr_percent_tolerance, a.type3->tolerance_limits,
               s.grr_accepted_percent);
        to.add("%GRR TV", "%", a.type3->grr_percent_total, a.type3->total_limits);
        to.add("ndc", "", a.type3->ndc, a.type3->ndc_limits, s.ndc);
    }
    if (a.linearity) {
        to.begin(Study::linearity, a.linearity->verdict);
        to.add("slope", "mm/mm", a.linearity->line.slope, a.linearity->line.slope_limits);
        to.add("intercept", "mm", a.linearity->line.intercept, a.linearity->line.intercept_limits);
    }
    if (a.stability) {
        to.begin(Study::stability, a.stability->verdict);
        to.add("centre", "mm", a.stability->centre_mm, a.stability->centre_limits);
        to.add("sigma", "mm", a.stability->sigma_mm);
        to.add("alarms", "", static_cast<double>(a.stability->alarms.size()), {}, 0);
    }
    if (a.correlation) {
        to.begin(Study::correlation, a.correlation->verdict);
        to.add("offset", "mm", a.correlation->offset_mm, a.correlation->offset_limits);
        to.add("slope", "mm/mm", a.correlation->line.slope, a.correlation->line.slope_limits);
        to.add("r", "", a.correlation->r);
    }
    if (a.vda5) {
        to.begin(Study::vda5, a.vda5->verdict);
        to.add("u_MS", "mm", a.vda5->u_ms_mm, a.vda5->u_ms_limits);
        to.add("u_MP", "mm", a.vda5->u_mp_mm, a.vda5->u_mp_limits);
        to.add("Q_MS", "%", a.vda5->q_ms_percent, a.vda5->q_ms_limits, s.system_percent);
        to.add("Q_MP", "%", a.vda5->q_mp_percent, a.vda5->q_mp_limits, s.process_percent);
    }
}

}  // namespace

Workbook acceptance_workbook(const Acceptance& acceptance, Language language) {
    Indices indices(language);
    add_indices(indices, acceptance);
    Workbook workbook;
    workbook.sheets.push_back(indices.sheet);
    if (acceptance.type3) {
        Sheet anova{
            "ANOVA",
            {{indices.word("Source"), std::string("df"), std::string("SS mm2"), std::string("MS mm2")}}};
        for (const AnovaRow& row : acceptance.type3->anova)
            anova.rows.push_back({std::string(row.source), row.df, row.ss,
                                  row.source == std::string_view("total") ? Cell() : Cell(row.ms)});
        workbook.sheets.push_back(std::move(anova));
    }
    Sheet values{
        indices.word("Values"),
        {{indices.word("Part"), indices.word("Rehang"), indices.word("Run"), indices.word("Value") + " mm",
          indices.word("Reference") + " mm", indices.word("Time (UTC)")}}};
    for (const StudyValue& v : acceptance.values.all())
        values.rows.push_back({v.part, v.rehang, static_cast<double>(v.run), v.value_mm,
                               v.reference_mm ? Cell(*v.reference_mm) : Cell(), v.utc});
    workbook.sheets.push_back(std::move(values));
    return workbook;
}

}  // namespace seamwright
