// A peer of another vendor, for the tests of DDS Security: listens to /joint_states and publishes /motor_voltage, as a controller would.
//
//   peer DOMAIN ENCLAVE SECONDS [DAYS [bold]]
//
// ENCLAVE is a folder of an SROS 2 keystore, or "clear" for no security at all; the peer believes that it is DAYS earlier than it is.
// A bold one allows itself everything: its own middleware does not hold it to its permissions, which it shows to others as they are.
// What happens is told one line an event: "ready", "refused ...", "authorised ...", "matched states N", "matched voltage N",
// "state ...", and at the end "states N sent N".

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

// A clock that is late, for a peer that does not see that its own certificate is over. Defined here, these count for every library.
static time_t seconds_late = 0;

extern "C" int clock_gettime(clockid_t clock, struct timespec *now) noexcept {
    const auto result = static_cast<int>(syscall(SYS_clock_gettime, clock, now));
    if (clock == CLOCK_REALTIME) {
        now->tv_sec -= seconds_late;
    }
    return result;
}

extern "C" time_t time(time_t *into) noexcept {
    struct timespec now {};
    clock_gettime(CLOCK_REALTIME, &now);
    if (into != nullptr) {
        *into = now.tv_sec;
    }
    return now.tv_sec;
}

// What the middleware compares topics with permissions by.
static bool bold = false;

extern "C" int fnmatch(const char *pattern, const char *topic, int flags) noexcept {
    (void)flags;
    const bool all = pattern[0] == '*' && pattern[1] == 0;
    return bold || all || std::strcmp(pattern, topic) == 0 ? 0 : 1;
}

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

// A message as its bytes: little-endian CDR behind the four bytes of the header.
struct Bytes {
    std::vector<uint8_t> content;

    void align(size_t to) {
        while ((content.size() - 4) % to != 0) {
            content.push_back(0);
        }
    }
    template <typename T>
    void put(T value) {
        align(sizeof value);
        const auto *from = reinterpret_cast<const uint8_t *>(&value);
        content.insert(content.end(), from, from + sizeof value);
    }
    void put_text(const std::string &text) {
        put(static_cast<uint32_t>(text.size() + 1));
        content.insert(content.end(), text.begin(), text.end());
        content.push_back(0);
    }
};

class BytesType : public TopicDataType {
public:
    explicit BytesType(const char *name) {
        setName(name);
        m_typeSize = 4096;
        m_isGetKeyDefined = false;
    }
    bool serialize(void *data, SerializedPayload_t *payload) override {
        const auto &content = static_cast<Bytes *>(data)->content;
        if (payload->max_size < content.size()) {
            return false;
        }
        std::memcpy(payload->data, content.data(), content.size());
        payload->length = static_cast<uint32_t>(content.size());
        payload->encapsulation = CDR_LE;
        return true;
    }
    bool deserialize(SerializedPayload_t *payload, void *data) override {
        static_cast<Bytes *>(data)->content.assign(payload->data, payload->data + payload->length);
        return true;
    }
    std::function<uint32_t()> getSerializedSizeProvider(void *data) override {
        return [data]() { return static_cast<uint32_t>(static_cast<Bytes *>(data)->content.size()); };
    }
    void *createData() override { return new Bytes; }
    void deleteData(void *data) override { delete static_cast<Bytes *>(data); }
    bool getKey(void *, InstanceHandle_t *, bool) override { return false; }
};

// The stamp of a message is its first member.
struct Stamp {
    int32_t sec = 0;
    uint32_t nanosec = 0;
};

class Heard : public DataReaderListener {
public:
    std::atomic<uint64_t> states{0};
    std::atomic<uint64_t> stamp{0};

    void on_data_available(DataReader *reader) override {
        Bytes message;
        SampleInfo info;
        while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data || message.content.size() < 12) {
                continue;
            }
            uint64_t stamp_now = 0;
            std::memcpy(&stamp_now, message.content.data() + 4, sizeof stamp_now);
            stamp = stamp_now;
            if (states++ == 0) {
                std::cout << "state of " << message.content.size() << " bytes" << std::endl;
            }
        }
    }
    void on_subscription_matched(DataReader *, const SubscriptionMatchedStatus &status) override {
        std::cout << "matched states " << status.current_count << std::endl;
    }
};

class Matched : public DataWriterListener {
    void on_publication_matched(DataWriter *, const PublicationMatchedStatus &status) override {
        std::cout << "matched voltage " << status.current_count << std::endl;
    }
};

class Authenticated : public DomainParticipantListener {
    void onParticipantAuthentication(
            DomainParticipant *, eprosima::fastrtps::rtps::ParticipantAuthenticationInfo &&info) override {
        using Info = eprosima::fastrtps::rtps::ParticipantAuthenticationInfo;
        std::cout << (info.status == Info::AUTHORIZED_PARTICIPANT ? "authorised " : "unauthorised ")
                  << info.guid << std::endl;
    }
};

int main(int count, char **arguments) {
    if (count < 4) {
        std::cerr << "peer DOMAIN ENCLAVE SECONDS [DAYS [bold]]" << std::endl;
        return 2;
    }
    const auto domain = static_cast<uint32_t>(std::stoul(arguments[1]));
    const std::string enclave = arguments[2];
    const double seconds = std::stod(arguments[3]);
    seconds_late = count > 4 ? 86400 * std::stol(arguments[4]) : 0;
    bold = count > 5 && std::strcmp(arguments[5], "bold") == 0;

    DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
    qos.name("peer");
    // As in a container or a network of its own: what goes over shared memory would bypass the network that is tested here.
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(
            std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>());
    if (enclave != "clear") {
        auto &properties = qos.properties().properties();
        const auto file = [&](const char *name) { return "file://" + enclave + "/" + name; };
        const std::string access = "dds.sec.access.builtin.Access-Permissions.";
        const std::string identity = "dds.sec.auth.builtin.PKI-DH.";
        properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
        properties.emplace_back(identity + "identity_ca", file("identity_ca.cert.pem"));
        properties.emplace_back(identity + "identity_certificate", file("cert.pem"));
        properties.emplace_back(identity + "private_key", file("key.pem"));
        properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
        properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
        properties.emplace_back(access + "permissions_ca", file("permissions_ca.cert.pem"));
        properties.emplace_back(access + "governance", file("governance.p7s"));
        properties.emplace_back(access + "permissions", file("permissions.p7s"));
    }
    Authenticated authenticated;
    auto *participant =
            DomainParticipantFactory::get_instance()->create_participant(domain, qos, &authenticated, StatusMask::none());
    if (participant == nullptr) {
        std::cout << "refused participant" << std::endl;
        return 1;
    }

    TypeSupport state_type(new BytesType("sensor_msgs::msg::dds_::JointState_"));
    TypeSupport voltage_type(new BytesType("friction_msgs::msg::dds_::MotorVoltage_"));
    state_type.register_type(participant);
    voltage_type.register_type(participant);
    auto *state = participant->create_topic("rt/joint_states", state_type.get_type_name(), TOPIC_QOS_DEFAULT);
    auto *voltage = participant->create_topic("rt/motor_voltage", voltage_type.get_type_name(), TOPIC_QOS_DEFAULT);

    Heard heard;
    Matched matched;
    DataReaderQos reader_qos = DATAREADER_QOS_DEFAULT;
    reader_qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    DataWriterQos writer_qos = DATAWRITER_QOS_DEFAULT;
    writer_qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    auto *subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    auto *publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
    auto *reader = subscriber->create_datareader(state, reader_qos, &heard);
    auto *writer = publisher->create_datawriter(voltage, writer_qos, &matched);
    if (reader == nullptr) {
        std::cout << "refused states" << std::endl;
    }
    if (writer == nullptr) {
        std::cout << "refused voltage" << std::endl;
    }

    std::cout << "ready" << std::endl;
    uint64_t sent = 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
        Stamp stamp;
        const uint64_t last = heard.stamp;
        std::memcpy(&stamp, &last, sizeof stamp);
        if (last == 0) {
            const auto now = std::chrono::system_clock::now().time_since_epoch();
            const auto nanos = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
            stamp.sec = static_cast<int32_t>(nanos / 1000000000);
            stamp.nanosec = static_cast<uint32_t>(nanos % 1000000000);
        }
        Bytes message;
        message.content = {0, 1, 0, 0};
        message.put(stamp.sec);
        message.put(stamp.nanosec);
        message.put_text("");
        message.put(1.5);
        if (writer != nullptr && writer->write(&message)) {
            sent++;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::cout << "states " << heard.states << " sent " << sent << std::endl;
    participant->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant);
    return 0;
}
