// APT source and cutter location data (ISO 4343), as CATIA and NX write them.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {
namespace {

// CIRCLE/1,2,3 -> "CIRCLE" and its fields; a field is a number or a word.
struct Record {
    std::string major;
    std::vector<Token> fields;
};

std::vector<double> numbers_of(const std::vector<Token>& fields, std::size_t from = 0) {
    std::vector<double> n;
    for (std::size_t i = from; i < fields.size() && fields[i].kind == Token::Kind::number; ++i)
        n.push_back(fields[i].number);
    return n;
}

class Apt final : public Machine {
  public:
    explicit Apt(const ProgramPathOptions& options) : Machine(Dialect::krl, options) {
        mm_ = options.unit_mm;
    }

    void load(int file, std::string_view text) override {
        if (file != 0) return;
        std::string record;
        int line = 0, begin = 0;
        Routine all;
        all.name = "PARTNO";
        while (!text.empty()) {
            ++line;
            const std::size_t end = std::min(text.find('\n'), text.size());
            std::string now(text.substr(0, end));
            text.remove_prefix(std::min(end + 1, text.size()));
            if (const auto comment = now.find("$$"); comment != std::string::npos) now.resize(comment);
            while (!now.empty() && (now.back() == ' ' || now.back() == '\t' || now.back() == '\r'))
                now.pop_back();
            const auto first = now.find_first_not_of(" \t");
            if (first == std::string::npos && record.empty()) continue;
            if (record.empty()) begin = line;
            const bool goes_on = !now.empty() && now.back() == '$' && record.size() < 100'000;
            if (goes_on) now.pop_back();
            record += now.substr(std::min(first, now.size()));
            if (goes_on && !text.empty()) continue;
            Statement s;
            s.line = begin;
            s.tokens = fields_of(record, begin);
            record.clear();
            if (s.tokens.empty()) continue;
            note(0, begin, LineKind::not_reached);
            all.body.push_back(std::move(s));
        }
        Statement end;  // when every point is known, so are the travels
        end.line = line;
        end.tokens = {{Token::Kind::end, "", 0, line}};
        all.body.push_back(std::move(end));
        routine_order_.push_back(all.name);
        add_routine(std::move(all));
    }

  protected:
    bool moves(const std::string& word) const override {
        return word == "GOTO" || word == "FROM" || word == "GODLTA" || word == "GOFWD" || word == "TLON";
    }
    void begin() override { set_frame({"", Pose::Identity()}); }
    Value call(const Expr& e) override { return Value::unknown(shown(e)); }

    Flow execute(const Statement& s) override {
        if (s.tokens.front().kind == Token::Kind::end) {
            lay_out();
            return Flow::on;
        }
        const std::string& word = s.tokens.front().text;
        const std::vector<Token> f(s.tokens.begin() + 1, s.tokens.end());
        const std::vector<double> n = numbers_of(f);
        const auto is = [&](std::string_view w) { return !f.empty() && f.front().text == w; };
        if (word == "GOTO" || word == "FROM") {
            if (n.size() < 3) return broken();
            if (!unit_known()) return Flow::on;
            if (cycle_) {
                gap("a cycle moves about this point by itself");
                return Flow::on;
            }
            if (n.size() >= 6) set_axis({n[3], n[4], n[5]});
            const Eigen::Vector3d p = frame_point({n[0], n[1], n[2]});
            if (circle_ && word == "GOTO")
                round_to(p);
            else
                add(p);
            circle_.reset();
        } else if (word == "GODLTA") {
            if (!unit_known()) return Flow::on;
            if (!last_ || n.empty() || n.size() == 2) return broken();
            const Eigen::Vector3d by =
                n.size() >= 3 ? Eigen::Vector3d(n[0], n[1], n[2]) : Eigen::Vector3d(n[0] * axis_);
            add(*last_ + mm_ * (n.size() >= 3 ? Eigen::Vector3d(msys_.linear() * by) : by));
        } else if (word == "CIRCLE") {
            if (n.size() < 7) return broken();
            if (!unit_known()) return Flow::on;
            circle_ =
                Circle{frame_point({n[0], n[1], n[2]}), msys_.linear() * Eigen::Vector3d(n[3], n[4], n[5])};
            note(LineKind::understood);
        } else if (word == "INDIRV" || word == "TLAXIS") {
            if (n.size() < 3) return broken();
            const Eigen::Vector3d v = msys_.linear() * Eigen::Vector3d(n[0], n[1], n[2]);
            if (word == "INDIRV")
                heading_ = v;
            else
                set_axis({n[0], n[1], n[2]});
            note(LineKind::understood);
        } else if (word == "TLON" || word == "GOFWD") {
            around(f);
        } else if (word == "UNITS") {
            const double mm = is("MM")                                 ? 1
                              : is("INCH") || is("INCHES") || is("IN") ? 25.4
                              : is("CM")                               ? 10
                              : is("M")                                ? 1000
                                                                       : 0;
            if (mm == 0) return broken();
            mm_ = mm;
            note(LineKind::understood);
        } else if (word == "MSYS") {
            const bool right = n.size() >= 9;
            const Eigen::Vector3d x = right ? Eigen::Vector3d(n[3], n[4], n[5]) : Eigen::Vector3d::UnitX(),
                                  y = right ? Eigen::Vector3d(n[6], n[7], n[8]) : Eigen::Vector3d::UnitY();
            if (!right || x.norm() < 1e-6 || x.cross(y).norm() < 1e-6) return broken();
            Eigen::Matrix3d r;
            r.col(0) = x.normalized();
            r.col(2) = x.cross(y).normalized();
            r.col(1) = r.col(2).cross(r.col(0));
            if (!unit_known()) return Flow::on;
            msys_ = make_pose(r, mm_ * Eigen::Vector3d(n[0], n[1], n[2]));
            note(LineKind::understood);
        } else if (word == "CYCLE") {
            cycle_ = !is("OFF");
            note(cycle_ ? LineKind::not_understood : LineKind::understood,
                 cycle_ ? Text("a cycle moves about its points by itself") : Text());
        } else if (word == "CUTCOM" && !is("OFF")) {
            note(LineKind::not_understood, "the controller shifts the path by its tool's radius");
        } else if (word == "LOADTL" || word == "TOOLNO" || (word == "LOAD" && is("TOOL"))) {
            const std::size_t number = word == "LOAD" ? 1 : 0;
            loaded_ = fmt::format("{}/{}", word, f.size() <= number ? "" : f[number].text);
            note(LineKind::understood);
        } else if (word == "GOHOME") {
            note(LineKind::left_out, "joint values: the way to the path or from it");
        } else if (word == "MULTAX" || word == "FINI" || word == "END") {
            note(LineKind::understood);
            if (word == "FINI") lay_out();
        } else {
            static const std::set<std::string> idle = {
                "PARTNO", "MACHIN", "SPINDL", "COOLNT", "FEDRAT", "RAPID", "CUTTER", "CUTCOM",
                "DELAY",  "STOP",   "OPSTOP", "PPRINT", "INSERT", "INTOL", "OUTTOL", "REWIND",
                "SELECT", "AUXFUN", "PREFUN", "PAINT",  "CATMAT", "TOOL",  "DISPLY", "LINTOL",
                "CLEARP", "SEQNO",  "LEADER", "TLDATA", "SHAFT",  "LOAD",  "UNLOAD", "OPNAME",
                "CATPRO", "REMARK", "MODE",   "CLRSRF", "CLAMP",  "BREAK", "RETRCT", "ARCSLP",
                "VERIFY", "HEAD",   "PRINT",  "NOPOST", "CLPRNT", "SYN",   "CUTANG", "PAINTING"};
            if (idle.count(word) > 0)
                note(LineKind::passed_over);
            else
                note(LineKind::not_understood, "this is not known here");
        }
        return Flow::on;
    }

  private:
    struct Circle {
        Eigen::Vector3d centre, axis;
    };
    struct Stop {
        int line;
        Eigen::Vector3d position, axis;
        ProgramMotion motion;
        std::string tool;
    };

    static std::vector<Token> fields_of(std::string_view record, int line) {
        std::vector<Token> out;
        const auto blank = [](char c) { return c == ' ' || c == '\t'; };
        std::size_t at = 0;
        while (at < record.size() && out.size() < 10000) {
            const char c = record[at];
            if (blank(c) || c == ',' || c == '/' || c == '=') {
                ++at;
            } else if (c == '(' || c == ')') {
                out.push_back({Token::Kind::sign, std::string(1, c), 0, line});
                ++at;
            } else {
                const std::size_t end = std::min(record.find_first_of(" \t,/=()", at), record.size());
                std::string word(record.substr(at, end - at));
                at = end;
                Token t{Token::Kind::name, word, 0, line};
                const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
                const auto [rest, problem] = std::from_chars(begin, word.data() + word.size(), t.number);
                if (problem == std::errc() && rest == word.data() + word.size() && std::isfinite(t.number))
                    t.kind = Token::Kind::number;
                else
                    std::transform(t.text.begin(), t.text.end(), t.text.begin(),
                                   [](unsigned char l) { return std::toupper(l); });
                out.push_back(std::move(t));
                if (out.size() == 1 &&
                    (out[0].text == "PPRINT" || out[0].text == "PARTNO" || out[0].text == "REMARK"))
                    break;
            }
        }
        return out;
    }

    Flow broken() {
        gap("the record has too few numbers");
        circle_.reset();
        return Flow::on;
    }
    bool unit_known() {
        if (mm_ > 0) return true;
        gap("the file states no UNITS");
        return false;
    }
    Eigen::Vector3d frame_point(const Eigen::Vector3d& p) const { return msys_ * Eigen::Vector3d(mm_ * p); }
    void set_axis(const Eigen::Vector3d& v) {
        const Eigen::Vector3d turned = msys_.linear() * v;
        if (turned.norm() > 1e-6 && turned.allFinite()) axis_ = turned.normalized();
    }
    void add(const Eigen::Vector3d& p, ProgramMotion motion = ProgramMotion::linear) {
        if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 1e5) return gap("the point lies beyond 100 m");
        if (stops_.size() >= kPathPointLimit) return gap("there are too many points");
        note(LineKind::understood);
        stops_.push_back({now_line_, p, axis_, motion, loaded_});
        last_ = p;
    }

    // About the circle's axis, in the positive sense; a circle that ends where it begins is a whole one.
    void round_to(const Eigen::Vector3d& end) {
        if (!last_) return gap("where this circle begins is not known");
        const Eigen::Vector3d n = circle_->axis.norm() > 1e-9 ? circle_->axis.normalized() : axis_;
        const Eigen::Vector3d from = *last_ - circle_->centre, to = end - circle_->centre;
        const Eigen::Vector3d x = from - from.dot(n) * n, b = to - to.dot(n) * n;
        const double radius = x.norm();
        if (radius < 1e-3 || std::abs(b.norm() - radius) > std::max(0.1, 0.01 * radius))
            return gap("the circle does not run through its ends");
        const Eigen::Vector3d u = x / radius, v = n.cross(u);
        double angle = std::atan2(b.dot(v), b.dot(u));
        if (angle <= 1e-9) angle += 2 * kPi;
        const double step =
            2 * std::acos(std::max(0.0, 1 - std::clamp(options_.chord_mm, 1e-4, radius) / radius));
        const int pieces = std::max(1, static_cast<int>(std::ceil(angle / step - 1e-9)));
        const double rise = (to - from).dot(n);
        for (int i = 1; i < pieces; ++i) {
            const double share = static_cast<double>(i) / pieces, t = angle * share;
            add(circle_->centre + from.dot(n) * n + rise * share * n +
                    radius * (std::cos(t) * u + std::sin(t) * v),
                ProgramMotion::circular);
        }
        add(end, ProgramMotion::circular);
    }

    // CATIA: INDIRV/tx,ty,tz  TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x2,y2,z2)
    void around(const std::vector<Token>& f) {
        const auto at = [&](std::string_view word) {
            return static_cast<std::size_t>(
                std::find_if(f.begin(), f.end(), [&](const Token& t) { return t.text == word; }) - f.begin());
        };
        const std::size_t circle = at("CIRCLE"), line = at("LINE");
        const std::vector<double> c = numbers_of(f, std::min(circle + 1, f.size())),
                                  l = numbers_of(f, std::min(line + 1, f.size()));
        if (!unit_known()) return;
        if (c.size() < 4 || l.size() < 6 || !last_ || !heading_)
            return gap("this form of a circle is not known here");
        const Eigen::Vector3d centre = frame_point({c[0], c[1], c[2]});
        Eigen::Vector3d out = frame_point({l[3], l[4], l[5]}) - frame_point({l[0], l[1], l[2]});
        out -= out.dot(axis_) * axis_;
        if (out.norm() < 1e-9) return gap("this form of a circle is not known here");
        const double turn = axis_.cross(*last_ - centre).dot(*heading_);
        circle_ = Circle{centre, turn < 0 ? Eigen::Vector3d(-axis_) : axis_};
        round_to(centre + mm_ * c[3] * out.normalized());
        circle_.reset();
        heading_.reset();
    }

    // Every stop as a pose: z against the axis, x along the travel.
    void lay_out() {
        Eigen::Vector3d x = Eigen::Vector3d::UnitX();
        for (std::size_t i = 0; i < stops_.size(); ++i) {
            const Stop& s = stops_[i];
            const Eigen::Vector3d z = -s.axis;
            const auto across = [&](const Eigen::Vector3d& d) { return Eigen::Vector3d(d - d.dot(z) * z); };
            const Eigen::Vector3d travel = across(stops_[std::min(i + 1, stops_.size() - 1)].position -
                                                  stops_[i > 0 ? i - 1 : 0].position);
            if (travel.norm() > 1e-6)
                x = travel.normalized();
            else if (across(x).norm() > 1e-3)
                x = across(x).normalized();
            else
                x = across(std::abs(z.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY())
                        .normalized();
            Eigen::Matrix3d r;
            r.col(0) = x;
            r.col(1) = z.cross(x);
            r.col(2) = z;
            now_line_ = s.line;
            tool_ = s.tool;
            move(make_pose(r, s.position), s.motion, "");
        }
        if (!stops_.empty())
            remark(
                "APT leaves the rotation about the tool's axis open: x is laid along the travel, z into the "
                "part");
        stops_.clear();
    }

    double mm_ = 0;
    Pose msys_ = Pose::Identity();
    Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();
    std::optional<Eigen::Vector3d> last_, heading_;
    std::optional<Circle> circle_;
    bool cycle_ = false;
    std::string loaded_;
    std::vector<Stop> stops_;
};

}  // namespace

std::unique_ptr<Machine> apt_machine(const ProgramPathOptions& options) {
    return std::make_unique<Apt>(options);
}

}  // namespace seamwright::program_path
