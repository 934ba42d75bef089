#include "tests/drivers/aravis/sfnc_camera.h"

#include <filesystem>
#include <fstream>
#include <vector>

#include <unistd.h>

namespace roomcal::drivers {

namespace {

struct Entry {
  const char* name;
  int value;
};

std::string tag(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}

std::string node(const std::string& kind, const std::string& name, const std::string& content) {
  return "<" + kind + " Name=\"" + name + "\" NameSpace=\"Standard\">" + content + "</" + kind + ">\n";
}

// `selected` steps through the register by 0x20 a selector's value.
std::string reg(const std::string& name, const char* address, const char* access = "RW", const char* selector = "") {
  const std::string index = *selector == '\0' ? "" : "<pIndex Offset=\"0x20\">" + std::string(selector) + "</pIndex>";
  return node("IntReg", name + "Register",
              tag("Address", address) + index + tag("Length", "4") + tag("AccessMode", access) +
                  tag("pPort", "Device") + tag("Cachable", "NoCache") + tag("Sign", "Unsigned") +
                  tag("Endianess", "BigEndian"));
}

std::string value_of(const std::string& name) { return tag("pValue", name + "Register"); }

std::string integer(const std::string& name, const char* address, const char* least, const char* most,
                    const char* access = "RW") {
  return node("Integer", name, value_of(name) + tag("Min", least) + tag("Max", most)) + reg(name, address, access);
}

std::string enumeration(const std::string& name, const std::vector<Entry>& entries, const std::string& value) {
  std::string content;
  for (const Entry& entry : entries)
    content += node("EnumEntry", entry.name, tag("Value", std::to_string(entry.value)));
  return node("Enumeration", name, content + value);
}

std::string enumeration_at(const std::string& name, const std::vector<Entry>& entries, const char* address,
                           const char* selector = "") {
  return enumeration(name, entries, value_of(name)) + reg(name, address, "RW", selector);
}

// A number that its register holds `per_unit` times.
std::string real(const std::string& name, const char* address, int per_unit, const char* least, const char* most) {
  const std::string factor = std::to_string(per_unit);
  return node("Float", name, tag("pValue", name + "Converter") + tag("Min", least) + tag("Max", most)) +
         node("Converter", name + "Converter",
              tag("FormulaTo", "FROM * " + factor) + tag("FormulaFrom", "TO / " + factor) + value_of(name)) +
         reg(name, address);
}

std::string boolean(const std::string& name, const char* address) {
  return node("Boolean", name, value_of(name) + tag("OnValue", "1") + tag("OffValue", "0")) + reg(name, address);
}

std::string command(const std::string& name, const std::string& register_name, int value) {
  return node("Command", name, tag("pValue", register_name) + tag("CommandValue", std::to_string(value)));
}

std::string image_format() {
  return integer("SensorWidth", "0x11c", "0", "2048", "RO") + integer("Width", "0x100", "16", "2048") +
         integer("Height", "0x104", "16", "2048") + integer("OffsetX", "0x130", "0", "1024") +
         integer("OffsetY", "0x134", "0", "1024") +
         enumeration_at("PixelFormat", {{"Mono8", 0x01080001}, {"Mono16", 0x01100007}}, "0x128") +
         node("IntSwissKnife", "PayloadSize",
              "<pVariable Name=\"W\">Width</pVariable><pVariable Name=\"H\">Height</pVariable>"
              "<pVariable Name=\"F\">PixelFormat</pVariable>" +
                  tag("Formula", "W * H * ((F &gt;&gt; 16) &amp; 0xFF) / 8")) +
         boolean("ChunkModeActive", "0x4100");
}

std::string acquisition() {
  const std::vector<Entry> off_on{{"Off", 0}, {"On", 1}};
  return reg("Acquisition", "0x124") + command("AcquisitionStart", "AcquisitionRegister", 1) +
         command("AcquisitionStop", "AcquisitionRegister", 0) +
         enumeration_at("AcquisitionMode", {{"Continuous", 1}, {"SingleFrame", 2}}, "0x12c") +
         boolean("AcquisitionFrameRateEnable", "0x4110") + real("AcquisitionFrameRate", "0x4114", 1, "1", "50") +
         enumeration_at("ExposureAuto", {{"Off", 0}, {"Continuous", 2}}, "0x4120") +
         real("ExposureTime", "0x120", 1, "20", "30000") +
         enumeration_at("GainAuto", {{"Off", 0}, {"Continuous", 2}}, "0x4130") + real("Gain", "0x4134", 10, "0", "24") +
         enumeration_at("TriggerSelector", {{"FrameStart", 0}, {"FrameBurstStart", 1}}, "0x4140") +
         enumeration_at("TriggerMode", off_on, "0x300", "TriggerSelectorRegister") +
         enumeration_at("TriggerSource", {{"Line0", 0}, {"Software", 1}, {"Line1", 2}, {"Action1", 3}}, "0x304",
                        "TriggerSelectorRegister") +
         reg("TriggerSoftware", "0x30c") + command("TriggerSoftware", "TriggerSoftwareRegister", 1);
}

std::string action() {
  return integer("ActionDeviceKey", "0x4200", "0", "4294967295", "WO") + integer("ActionSelector", "0x4204", "0", "1") +
         integer("ActionGroupKey", "0x4208", "0", "4294967295") +
         integer("ActionGroupMask", "0x420c", "0", "4294967295");
}

std::string ptp() {
  return boolean("PtpEnable", "0x4300") + reg("PtpLatch", "0x4304") +
         command("PtpDataSetLatch", "PtpLatchRegister", 1) +
         enumeration("PtpStatus", {{"Disabled", 0}, {"Uncalibrated", 1}, {"Slave", 9}},
                     tag("pValue", "PtpStatusKnife")) +
         node("IntSwissKnife", "PtpStatusKnife",
              "<pVariable Name=\"ON\">PtpEnableRegister</pVariable>" + tag("Formula", "ON * 9"));
}

}  // namespace

std::string sfnc_camera_xml() {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
         "<RegisterDescription ModelName=\"Sfnc\" VendorName=\"roomcal\" StandardNameSpace=\"None\" "
         "SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" SchemaSubMinorVersion=\"0\" MajorVersion=\"1\" "
         "MinorVersion=\"0\" SubMinorVersion=\"0\" ToolTip=\"\" "
         "ProductGuid=\"00000000-0000-0000-0000-000000000000\" VersionGuid=\"00000000-0000-0000-0000-000000000000\" "
         "xmlns=\"http://www.genicam.org/GenApi/Version_1_1\">\n" +
         node("Category", "Root", tag("pFeature", "Width")) + image_format() + acquisition() + action() + ptp() +
         "<Port Name=\"Device\" NameSpace=\"Standard\"/>\n</RegisterDescription>\n";
}

SfncCameraFile::SfncCameraFile()
    : path_(std::filesystem::temp_directory_path() / ("sfnc_camera." + std::to_string(::getpid()) + ".xml")) {
  std::ofstream(path_) << sfnc_camera_xml();
}

SfncCameraFile::~SfncCameraFile() { std::filesystem::remove(path_); }

}  // namespace roomcal::drivers
