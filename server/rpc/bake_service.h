// lightwell.v1.BakeService over gRPC's callback interface: an idle watch or a stalled upload costs memory, never a thread.
#pragma once
#include <atomic>
#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "lightwell/v1/service.grpc.pb.h"
#include "server/tokens.h"
#include "server/rpc/work_queue.h"
#include "server/store/blob_store.h"
#include "server/store/retention.h"
#include "server/store/uploads.h"
#include "server/execution/jobs.h"

namespace lightwell::server {

struct ServiceLimits {
  uint32_t max_unfinished_jobs = 0;   // of one client
  uint32_t max_watches = 0;           // of all clients
  uint32_t max_uploads = 0;           // streams at once
  double upload_idle_s = 0;           // an upload that sends nothing for so long is ended
};

/// What the service works on. All outlive it.
struct ServiceParts {
  Jobs& jobs;
  Uploads& uploads;
  BlobStore& blobs;
  Retention& retention;
  const Tokens& tokens;
  v1::ServerInfo info;                // the fixed part of it
  ServiceLimits limits;
  std::function<void(double seconds)> submitted;  // for metrics; may be empty
};

/// A call that stays open, so that the service can end it.
class OpenStream {
 public:
  virtual ~OpenStream() = default;
  virtual void end(const Failure& why) = 0;
  /// Called every second.
  virtual void tick() {}
};

class BakeService final : public v1::BakeService::CallbackService {
 public:
  explicit BakeService(ServiceParts parts);
  ~BakeService() override;

  /// Ends all open streams, and refuses new ones.
  void shutDown();
  /// Called every second.
  void tick();
  uint32_t watches() const { return watches_; }
  uint32_t uploads() const { return uploads_; }

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext*, const v1::GetServerInfoRequest*, v1::ServerInfo*) override;
  grpc::ServerUnaryReactor* FindUploads(grpc::CallbackServerContext*, const v1::FindUploadsRequest*, v1::FindUploadsResponse*) override;
  grpc::ServerReadReactor<v1::UploadRequest>* Upload(grpc::CallbackServerContext*, v1::UploadState*) override;
  grpc::ServerUnaryReactor* SubmitJob(grpc::CallbackServerContext*, const v1::SubmitJobRequest*, v1::Job*) override;
  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext*, const v1::GetJobRequest*, v1::Job*) override;
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext*, const v1::ListJobsRequest*, v1::ListJobsResponse*) override;
  grpc::ServerWriteReactor<v1::Job>* WatchJob(grpc::CallbackServerContext*, const v1::WatchJobRequest*) override;
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext*, const v1::CancelJobRequest*, v1::Job*) override;
  grpc::ServerUnaryReactor* DeleteJob(grpc::CallbackServerContext*, const v1::DeleteJobRequest*, v1::DeleteJobResponse*) override;
  grpc::ServerWriteReactor<v1::DownloadResultResponse>* DownloadResult(grpc::CallbackServerContext*,
                                                                       const v1::DownloadResultRequest*) override;

 private:
  friend class WatchStream;
  friend class UploadStream;
  friend grpc::ServerReadReactor<v1::UploadRequest>* makeUploadStream(BakeService&, ServiceParts&, grpc::CallbackServerContext*,
                                                                      const std::string&, v1::UploadState*);
  /// Throws Failure unauthenticated or shutting_down.
  std::string clientOf(const grpc::CallbackServerContext& context) const;
  /// Answers a unary call from the work queue.
  grpc::ServerUnaryReactor* answer(grpc::CallbackServerContext* context, std::function<void(const std::string& client)> body);
  void open(const std::shared_ptr<OpenStream>& stream);
  void close(const std::shared_ptr<OpenStream>& stream);

  ServiceParts parts_;
  std::atomic<bool> shutting_down_{false};
  std::atomic<uint32_t> watches_{0}, uploads_{0};
  std::mutex mutex_;
  std::set<std::shared_ptr<OpenStream>> streams_;
  WorkQueue queue_;  // last: its threads use the rest
};

/// Completes a status for the caller: the error id as trailing metadata too.
grpc::Status finished(grpc::CallbackServerContext* context, grpc::Status status);

/// The streams, each in a file of its own.
grpc::ServerReadReactor<v1::UploadRequest>* makeUploadStream(BakeService& service, ServiceParts& parts,
                                                             grpc::CallbackServerContext* context, const std::string& client,
                                                             v1::UploadState* response);
grpc::ServerWriteReactor<v1::DownloadResultResponse>* makeDownloadStream(ServiceParts& parts, grpc::CallbackServerContext* context,
                                                                         const v1::DownloadResultRequest& request, const std::string& client);

}  // namespace lightwell::server
