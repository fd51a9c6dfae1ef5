#include "devices/abb/egm_message.h"

#include <cmath>
#include <exception>
#include <string>

#include "egm.pb.h"

namespace seamwright {
namespace {

namespace egm = ::abb::egm;

tl::unexpected<Error> refused(const char* wrong) {
    return device_error(Text("an EGM message is refused: {}", wrong));
}

template <class Message>
const char* read(std::span<const std::byte> datagram, Message& message) {
    if (datagram.size() > kLargestEgmMessage) return "it is too long";
    try {
        if (!message.ParsePartialFromArray(datagram.data(), static_cast<int>(datagram.size())))
            return "it is no protobuf message";
    } catch (const std::exception&) {
        return "it cannot be held";
    }
    if (!message.has_header() || !message.header().has_seqno()) return "it has no sequence number";
    return nullptr;
}

// nullptr, or what is wrong.
const char* pose_of(const egm::EgmPose& m, std::optional<Pose>& pose, bool& usable) {
    if (!m.has_pos() || !m.has_orient())
        return nullptr;  // orientation as Euler angles alone: not sent by robots
    const auto& p = m.pos();
    const auto& q = m.orient();
    if (!p.has_x() || !p.has_y() || !p.has_z()) return "a position is incomplete";
    if (!q.has_u0() || !q.has_u1() || !q.has_u2() || !q.has_u3()) return "a quaternion is incomplete";
    const Eigen::Vector3d t(p.x(), p.y(), p.z());
    Eigen::Quaterniond r(q.u0(), q.u1(), q.u2(), q.u3());
    const double norm = r.norm();
    if (!(t.cwiseAbs().maxCoeff() <= 1e5) || !t.allFinite() || !(std::abs(norm - 1) <= 1e-3)) {
        usable = false;
        return nullptr;
    }
    r.coeffs() /= norm;
    pose = make_pose(r.toRotationMatrix(), t);
    return nullptr;
}

void put(const Pose& pose, egm::EgmPose& m) {
    m.mutable_pos()->set_x(pose.translation().x());
    m.mutable_pos()->set_y(pose.translation().y());
    m.mutable_pos()->set_z(pose.translation().z());
    const Eigen::Quaterniond q(pose.linear());
    m.mutable_orient()->set_u0(q.w());
    m.mutable_orient()->set_u1(q.x());
    m.mutable_orient()->set_u2(q.y());
    m.mutable_orient()->set_u3(q.z());
}

template <class Message>
std::span<const std::byte> write(std::span<std::byte> buffer, const Message& message) {
    const std::size_t size = message.ByteSizeLong();
    if (size > buffer.size()) return {};
    if (!message.SerializePartialToArray(buffer.data(), static_cast<int>(buffer.size()))) return {};
    return buffer.first(size);
}

}  // namespace

Expected<EgmState> parse_egm_robot(std::span<const std::byte> datagram) {
    // Kept, so that its memory is that of the cycle before.
    thread_local egm::EgmRobot m;
    m.Clear();
    if (const char* wrong = read(datagram, m)) return refused(wrong);
    if (m.header().has_mtype() && m.header().mtype() != egm::EgmHeader::MSGTYPE_DATA)
        return refused("its type is not DATA");
    EgmState s;
    s.seqno = m.header().seqno();
    s.tm_ms = m.header().tm();
    if (const char* wrong = pose_of(m.planned().cartesian(), s.planned, s.usable)) return refused(wrong);
    if (const char* wrong = pose_of(m.feedback().cartesian(), s.measured, s.usable)) return refused(wrong);
    s.motors_on = m.motorstate().state() == egm::EgmMotorState::MOTORS_ON;
    s.rapid_running = m.rapidexecstate().state() == egm::EgmRapidCtrlExecState::RAPID_RUNNING;
    s.mci = static_cast<EgmMci>(m.mcistate().state());
    return s;
}

std::span<const std::byte> write_egm_robot(std::span<std::byte> buffer, const EgmState& s) {
    egm::EgmRobot m;
    m.mutable_header()->set_seqno(s.seqno);
    m.mutable_header()->set_tm(s.tm_ms);
    m.mutable_header()->set_mtype(egm::EgmHeader::MSGTYPE_DATA);
    if (s.measured) put(*s.measured, *m.mutable_feedback()->mutable_cartesian());
    if (s.planned) put(*s.planned, *m.mutable_planned()->mutable_cartesian());
    m.mutable_motorstate()->set_state(s.motors_on ? egm::EgmMotorState::MOTORS_ON
                                                  : egm::EgmMotorState::MOTORS_OFF);
    m.mutable_mcistate()->set_state(static_cast<egm::EgmMCIState::MCIStateType>(s.mci));
    m.mutable_rapidexecstate()->set_state(s.rapid_running ? egm::EgmRapidCtrlExecState::RAPID_RUNNING
                                                          : egm::EgmRapidCtrlExecState::RAPID_STOPPED);
    return write(buffer, m);
}

Expected<EgmPathCorrection> parse_egm_path_correction(std::span<const std::byte> datagram) {
    egm::EgmSensorPathCorr m;
    if (const char* wrong = read(datagram, m)) return refused(wrong);
    if (m.header().mtype() != egm::EgmHeader::MSGTYPE_PATH_CORRECTION)
        return refused("its type is not PATH_CORRECTION");
    const auto& c = m.pathcorr();
    if (!c.has_age() || !c.pos().has_x() || !c.pos().has_y() || !c.pos().has_z())
        return refused("the correction is incomplete");
    EgmPathCorrection value{
        m.header().seqno(), m.header().tm(), c.age(), {c.pos().x(), c.pos().y(), c.pos().z()}};
    if (!value.pos_mm.allFinite()) return refused("the correction is not finite");
    return value;
}

std::span<const std::byte> write_egm_path_correction(std::span<std::byte> buffer,
                                                     const EgmPathCorrection& v) {
    thread_local egm::EgmSensorPathCorr m;
    m.Clear();
    m.mutable_header()->set_seqno(v.seqno);
    m.mutable_header()->set_tm(v.tm_ms);
    m.mutable_header()->set_mtype(egm::EgmHeader::MSGTYPE_PATH_CORRECTION);
    m.mutable_pathcorr()->mutable_pos()->set_x(v.pos_mm.x());
    m.mutable_pathcorr()->mutable_pos()->set_y(v.pos_mm.y());
    m.mutable_pathcorr()->mutable_pos()->set_z(v.pos_mm.z());
    m.mutable_pathcorr()->set_age(v.age_ms);
    return write(buffer, m);
}

std::optional<Eigen::Matrix3d> reference_from_path(const Eigen::Vector3d& travel,
                                                   const Eigen::Vector3d& tool_z) {
    const double length = travel.norm();
    if (!(length > 0)) return std::nullopt;
    const Eigen::Vector3d x = travel / length;
    const Eigen::Vector3d y = tool_z.cross(x);
    if (!(y.norm() > 0.02 * tool_z.norm())) return std::nullopt;
    Eigen::Matrix3d r;
    r.col(0) = x;
    r.col(1) = y.normalized();
    r.col(2) = x.cross(r.col(1));
    return r;
}

}  // namespace seamwright
