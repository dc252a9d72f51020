// A client of the OpenIGTLink reference library (Debian's libopenigtlink-dev, header version 1).
//
// reference_client PORT [hostile] sends one message of each type to the server on 127.0.0.1, prints
// the first message of each device that it gets back, one a line, and ends when it has seen the
// devices in EXPECTED. A hostile one sends before what the server cannot use: images, trackers,
// requests, lies about lengths, damaged bodies; and ends in the middle of a message. The library of this version has no COMMAND: both of its forms are added
// here the way the library's own types are made.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string>

#include <arpa/inet.h>

#include "igtlCapabilityMessage.h"
#include "igtlClientSocket.h"
#include "igtlImageMessage.h"
#include "igtlMessageHeader.h"
#include "igtlPointMessage.h"
#include "igtlPositionMessage.h"
#include "igtlSensorMessage.h"
#include "igtlStatusMessage.h"
#include "igtlStringMessage.h"
#include "igtlTrackingDataMessage.h"
#include "igtlTransformMessage.h"

namespace {

const std::set<std::string> EXPECTED = {"Reference", "ToolTipToWorld", "SimState",
                                        "CapturedPoints", "SimServer", "command"};
const int COMMAND_HEADER_BYTES = 138;

class CommandMessage : public igtl::MessageBase {
public:
  typedef CommandMessage Self;
  typedef igtl::MessageBase Superclass;
  typedef igtl::SmartPointer<Self> Pointer;
  igtlTypeMacro(CommandMessage, igtl::MessageBase);
  igtlNewMacro(CommandMessage);

  uint32_t Id = 0;
  std::string Name, Body;

protected:
  CommandMessage() { this->m_DefaultBodyType = "COMMAND"; }

  int GetBodyPackSize() override { return COMMAND_HEADER_BYTES + static_cast<int>(Body.size()); }

  int PackBody() override {
    AllocatePack();
    std::memset(m_Body, 0, COMMAND_HEADER_BYTES);
    Put32(0, Id);
    std::memcpy(m_Body + 4, Name.data(), Name.size());
    m_Body[133] = 3;
    Put32(134, static_cast<uint32_t>(Body.size()));
    std::memcpy(m_Body + COMMAND_HEADER_BYTES, Body.data(), Body.size());
    return 1;
  }

  int UnpackBody() override {
    Id = Get32(0);
    Name = reinterpret_cast<char *>(m_Body + 4);
    Body.assign(reinterpret_cast<char *>(m_Body) + COMMAND_HEADER_BYTES, Get32(134));
    return 1;
  }

private:
  void Put32(int offset, uint32_t value) {
    value = htonl(value);
    std::memcpy(m_Body + offset, &value, 4);
  }
  uint32_t Get32(int offset) {
    uint32_t value;
    std::memcpy(&value, m_Body + offset, 4);
    return ntohl(value);
  }
};

class CommandReplyMessage : public CommandMessage {
public:
  typedef CommandReplyMessage Self;
  typedef CommandMessage Superclass;
  typedef igtl::SmartPointer<Self> Pointer;
  igtlTypeMacro(CommandReplyMessage, CommandMessage);
  igtlNewMacro(CommandReplyMessage);

protected:
  CommandReplyMessage() { this->m_DefaultBodyType = "RTS_COMMAND"; }
};

igtl::ClientSocket::Pointer server;

void Send(igtl::MessageBase *message, const char *device) {
  message->SetDeviceName(device);
  message->Pack();
  if (!server->Send(message->GetPackPointer(), message->GetPackSize())) {
    std::puts("the server does not take what is sent");
    std::exit(1);
  }
}

void SendOneOfEach() {
  igtl::Matrix4x4 matrix = {{0, -1, 0, 10.5}, {1, 0, 0, -20.25}, {0, 0, 1, 300.125}, {0, 0, 0, 1}};
  igtl::TransformMessage::Pointer transform = igtl::TransformMessage::New();
  transform->SetMatrix(matrix);
  Send(transform, "Reference");

  igtl::StringMessage::Pointer text = igtl::StringMessage::New();
  text->SetString("touch point 3");
  Send(text, "Note");

  igtl::PointMessage::Pointer points = igtl::PointMessage::New();
  igtl::PointElement::Pointer point = igtl::PointElement::New();
  point->SetName("7");
  point->SetGroupName("Fiducial");
  point->SetRGBA(1, 2, 3, 255);
  point->SetPosition(1.5f, -2.0f, 3.25f);
  points->AddPointElement(point);
  Send(points, "Points");

  igtl::StatusMessage::Pointer status = igtl::StatusMessage::New();
  status->SetCode(1);
  status->SetSubCode(42);
  status->SetErrorName("none");
  status->SetStatusString("well");
  Send(status, "Device");

  CommandMessage::Pointer command = CommandMessage::New();
  command->Id = 4711;
  command->Name = "Hello";
  command->Body = "{\"protocolVersion\": 1, \"client\": \"reference\"}";
  Send(command, "command");
}

// Sends what is packed with one byte changed, counted from the message's first.
void SendDamaged(igtl::MessageBase *message, int position) {
  message->SetDeviceName("Damaged");
  message->Pack();
  char *bytes = static_cast<char *>(message->GetPackPointer());
  bytes[position] = static_cast<char>(bytes[position] ^ 0x5a);
  server->Send(bytes, message->GetPackSize());
}

void SendWhatNobodyWants() {
  igtl::ImageMessage::Pointer image = igtl::ImageMessage::New();
  image->SetDimensions(64, 64, 20);
  image->SetSpacing(1.0f, 1.0f, 1.0f);
  image->SetScalarType(igtl::ImageMessage::TYPE_UINT8);
  image->AllocateScalars();
  std::memset(image->GetScalarPointer(), 0, image->GetImageSize());
  Send(image, "Image");

  igtl::PositionMessage::Pointer position = igtl::PositionMessage::New();
  position->SetPosition(1, 2, 3);
  Send(position, "Position");

  igtl::SensorMessage::Pointer sensor = igtl::SensorMessage::New();
  sensor->SetLength(6);
  Send(sensor, "Sensor");

  igtl::GetImageMessage::Pointer getImage = igtl::GetImageMessage::New();
  Send(getImage, "GetImage");
  igtl::StartTrackingDataMessage::Pointer start = igtl::StartTrackingDataMessage::New();
  start->SetResolution(10);
  Send(start, "Start");
  igtl::StopTrackingDataMessage::Pointer stop = igtl::StopTrackingDataMessage::New();
  Send(stop, "Stop");

  for (int position = 50; position < 106; ++position) {
    igtl::TransformMessage::Pointer transform = igtl::TransformMessage::New();
    SendDamaged(transform, position);
  }
}

void LeaveInTheMiddleOfAMessage() {
  igtl::StringMessage::Pointer text = igtl::StringMessage::New();
  text->SetString(std::string(1000, 'x').c_str());
  text->SetDeviceName("Half");
  text->Pack();
  server->Send(text->GetPackPointer(), text->GetPackSize() / 2);
}

// Receives the body that belongs to a header; false where the library finds it damaged.
bool Receive(igtl::MessageBase *message, igtl::MessageHeader *header) {
  message->SetMessageHeader(header);
  message->AllocatePack();
  server->Receive(message->GetPackBodyPointer(), message->GetPackBodySize());
  return message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY;
}

void Print(igtl::TransformMessage *message) {
  igtl::Matrix4x4 m;
  message->GetMatrix(m);
  for (int row = 0; row < 3; ++row)
    std::printf(" %g %g %g %g", m[row][0], m[row][1], m[row][2], m[row][3]);
}

void Print(igtl::PointMessage *message) {
  for (int i = 0; i < message->GetNumberOfPointElement(); ++i) {
    igtl::PointElement::Pointer point;
    message->GetPointElement(i, point);
    igtlFloat32 x, y, z;
    point->GetPosition(x, y, z);
    std::printf(" %s %g %g %g", point->GetName(), x, y, z);
  }
}

void Print(igtl::StringMessage *message) { std::printf(" %s", message->GetString()); }

void Print(igtl::StatusMessage *message) {
  std::printf(" %d %lld %s", message->GetCode(), static_cast<long long>(message->GetSubCode()),
              message->GetStatusString());
}

void Print(CommandReplyMessage *message) {
  std::printf(" %u %s %s", message->Id, message->Name.c_str(), message->Body.c_str());
}

template <class Message> void ReceiveAndPrint(igtl::MessageHeader *header, bool isFirst) {
  typename Message::Pointer message = Message::New();
  if (!Receive(message, header)) {
    std::printf("%s is damaged\n", header->GetDeviceName());
    std::exit(1);
  }
  if (!isFirst)
    return;
  std::printf("%s %s", header->GetDeviceType(), header->GetDeviceName());
  Print(message.GetPointer());
  std::printf("\n");
}

void ReceiveOne(std::set<std::string> &seen) {
  igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
  header->InitPack();
  if (server->Receive(header->GetPackPointer(), header->GetPackSize()) != header->GetPackSize()) {
    std::puts("the server sends nothing more");
    std::exit(1);
  }
  if (!(header->Unpack() & igtl::MessageHeader::UNPACK_HEADER)) {
    std::puts("a header is damaged, or not of version 1");
    std::exit(1);
  }
  const std::string type = header->GetDeviceType();
  const std::string device = header->GetDeviceName();
  const bool isFirst = EXPECTED.count(device) && seen.insert(device).second;
  if (type == "TRANSFORM")
    ReceiveAndPrint<igtl::TransformMessage>(header, isFirst);
  else if (type == "STRING")
    ReceiveAndPrint<igtl::StringMessage>(header, isFirst);
  else if (type == "POINT")
    ReceiveAndPrint<igtl::PointMessage>(header, isFirst);
  else if (type == "STATUS")
    ReceiveAndPrint<igtl::StatusMessage>(header, isFirst);
  else
    ReceiveAndPrint<CommandReplyMessage>(header, isFirst);
}

} // namespace

int main(int argc, char **argv) {
  const bool isHostile = argc == 3 && std::string(argv[2]) == "hostile";
  if (argc != 2 && !isHostile) {
    std::puts("usage: reference_client PORT [hostile]");
    return 2;
  }
  server = igtl::ClientSocket::New();
  if (server->ConnectToServer("127.0.0.1", std::atoi(argv[1])) != 0) {
    std::puts("no connection");
    return 1;
  }
  server->SetReceiveTimeout(60000);
  if (isHostile)
    SendWhatNobodyWants();
  SendOneOfEach();
  std::set<std::string> seen;
  while (seen.size() < EXPECTED.size())
    ReceiveOne(seen);
  if (isHostile)
    LeaveInTheMiddleOfAMessage();
  server->CloseSocket();
  return 0;
}
