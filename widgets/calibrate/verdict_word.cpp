#include "widgets/calibrate/verdict_word.h"

#include <QCoreApplication>

namespace seamwright {
namespace {

struct Words {
    Q_DECLARE_TR_FUNCTIONS(MethodText)
  public:
    static QString of(Verdict verdict) {
        switch (verdict) {
            case Verdict::good:
                return tr("good");
            case Verdict::usable:
                return tr("usable");
            case Verdict::poor:
                return tr("poor");
            case Verdict::undetermined:
                break;
        }
        return tr("undetermined");
    }
};

}  // namespace

QString verdict_word(Verdict verdict) {
    return Words::of(verdict);
}

}  // namespace seamwright
