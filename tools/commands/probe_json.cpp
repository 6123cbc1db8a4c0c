// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/probe_json.hpp"

#include <cmath>

#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

/// Beyond the last bin there is no bound: null.
Json bound_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json histogram_json(const LogHistogram& h) {
  return {{"lowest", h.lowest},
          {"ratio", h.ratio},
          {"count", h.count},
          {"median", bound_json(h.quantile(0.5))},
          {"p99", bound_json(h.quantile(0.99))},
          {"p999", bound_json(h.quantile(0.999))}};
}

Json refused_json(const HapticTelemetry& t) {
  return {{"not_finite", t.refused_not_finite},
          {"jumps", t.refused_jumps},
          {"clock", t.refused_clock},
          {"missing", t.missing_samples},
          {"recoveries", t.recoveries}};
}

Json telemetry_json(const HapticTelemetry& t) {
  return {{"ticks", t.ticks},
          {"sweeps", t.sweeps},
          {"idle_ticks", t.idle_ticks},
          {"deadline_misses", t.deadline_misses},
          {"unconverged_ticks", t.unconverged_ticks},
          {"publications", t.publications},
          {"hand_overs", t.hand_overs},
          {"samples_refused", refused_json(t)},
          {"dead_ticks", t.dead_ticks},
          {"clamped_ticks", t.clamped_ticks},
          {"limited_ticks", t.limited_ticks},
          {"contacts", t.contacts},
          {"active_contacts", t.active_contacts},
          {"contacts_left_out", t.contacts_left_out},
          {"active_sum", t.active_sum},
          {"contact_sum", t.contact_sum},
          {"largest_force_n", t.largest_force_n},
          {"largest_step_n", t.largest_step_n},
          {"largest_hand_over_step_n", t.largest_hand_over_step_n},
          {"longest_silence_s", t.longest_silence_s},
          {"tick_time_s", histogram_json(t.tick_time_s)},
          {"sweeps_per_tick", histogram_json(t.sweeps_per_tick)},
          {"residual", histogram_json(t.residual)},
          {"hand_over_step_n", histogram_json(t.hand_over_step_n)}};
}

Json udp_json(const std::optional<UdpDeviceCounts>& counts) {
  if (!counts) return nullptr;
  return {{"samples", counts->samples},
          {"limits", counts->limits},
          {"lost", counts->lost},
          {"overtaken", counts->overtaken},
          {"wrong_size", counts->wrong_size},
          {"wrong_head", counts->wrong_head},
          {"wrong_value", counts->wrong_value},
          {"replayed", counts->replayed},
          {"strangers", counts->strangers},
          {"not_sent", counts->not_sent}};
}

}  // namespace

Json probes_json(const std::vector<ProbeReport>& probes) {
  Json list = Json::array();
  for (const ProbeReport& p : probes) {
    Json probe = {{"name", p.name},
                  {"device", probe_device_name(p.device)},
                  {"rate_hz", p.rate_hz},
                  {"position_m", p.last_sample.pose.translation},
                  {"quaternion", p.last_sample.pose.rotation},
                  {"opening_rad", p.last_sample.opening_rad},
                  {"force_n", p.last_wrench.force_n},
                  {"torque_nm", p.last_wrench.torque_nm},
                  {"opening_nm", p.last_wrench.opening_nm}};
    probe["passivity"] = {{"scope", probe_passivity_name(p.passivity)},
                          {"energy_j", p.observed_energy_j},
                          {"dissipated_j", p.dissipated_j},
                          {"damped_ticks", p.damped_ticks}};
    probe["hand_received_j"] = p.hand_received_j ? Json(*p.hand_received_j) : Json(nullptr);
    probe["udp"] = udp_json(p.udp);
    probe["telemetry"] = telemetry_json(p.telemetry);
    list.push_back(std::move(probe));
  }
  return list;
}

std::string probe_line(const ProbeReport& p) {
  const HapticTelemetry& t = p.telemetry;
  const std::uint64_t refused = t.refused_not_finite + t.refused_jumps + t.refused_clock;
  return "probe " + p.name + ": " + std::to_string(t.ticks) + " ticks at " + rounded_text(p.rate_hz) +
         " Hz, median " + rounded_text(1e6 * t.tick_time_s.quantile(0.5), 3) + " us, p99.9 " +
         rounded_text(1e6 * t.tick_time_s.quantile(0.999), 3) + " us, " +
         std::to_string(t.deadline_misses) + " deadlines missed, " +
         std::to_string(t.unconverged_ticks) + " unconverged; force at most " +
         rounded_text(t.largest_force_n, 3) + " N, hand-over step at most " +
         rounded_text(t.largest_hand_over_step_n, 3) + " N; " + std::to_string(refused) +
         " samples refused\n";
}

}  // namespace souple
